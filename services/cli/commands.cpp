#include "commands.hpp"

#include "bag/bag_command.hpp"
#include "baton_commands.hpp"
#include "branch_command.hpp"
#include "controller_command.hpp"
#include "demo_command.hpp"
#include "figures_command.hpp"
#include "kills_command.hpp"
#include "laws_command.hpp"
#include "metrics_command.hpp"
#include "model_command.hpp"
#include "operate_commands.hpp"
#include "param_command.hpp"
#include "player_command.hpp"
#include "record_command.hpp"
#include "replay_command.hpp"
#include "rerun_command.hpp"
#include "run_commands.hpp"
#include "shadow_command.hpp"
#include "whatif_command.hpp"

namespace baton {

void addCommands(CLI::App& app, ExitCode& exit_code) {
  addDemoCommand(app, exit_code);
  addRunCommands(app, exit_code);
  addBatonCommands(app, exit_code);
  addControllerCommand(app, exit_code);
  addOperateCommands(app, exit_code);
  addParamCommand(app, exit_code);
  addRecordCommand(app, exit_code);
  addReplayCommand(app, exit_code);
  addPlayerCommand(app, exit_code);
  addBagCommand(app, exit_code);
  addBranchCommand(app, exit_code);
  addRerunCommand(app, exit_code);
  addKillsCommand(app, exit_code);
  addMetricsCommand(app, exit_code);
  addShadowCommand(app, exit_code);
  addWhatIfCommand(app, exit_code);
  addFiguresCommand(app, exit_code);
  addModelCommand(app, exit_code);
  addLawsCommand(app);
}

}  // namespace baton
