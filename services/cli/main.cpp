// The command line people type.
#include <CLI/CLI.hpp>

#include "bag_command.hpp"
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
#include "replay_command.hpp"
#include "rerun_command.hpp"
#include "run_commands.hpp"
#include "runtime/command_line.hpp"
#include "runtime/log.hpp"
#include "runtime/run.hpp"
#include "shadow_command.hpp"

int main(int argc, char** argv) {
  return baton::runGuarded("baton", [&] {
    baton::setUpLog("baton");
    baton::ExitCode exit_code = baton::ExitCode::kOk;
    CLI::App app{
        "Baton, a control laboratory on DDS: robot, wall, trajectory and controllers are processes of their own;\n"
        "controllers hand over live, everything is recorded. Every command has --help.\n"
        "Exit codes: 0 done, 1 tried and failed, 2 wrong input, 3 something needed is missing or taken,\n"
        "4 the run was stopped by its own policy, 130 interrupted."};
    app.name("baton");
    app.set_version_flag("--version", "baton " BATON_VERSION " (" BATON_COMPILER ", " BATON_FLAGS ")");
    app.require_subcommand(1);
    baton::addDemoCommand(app, exit_code);
    baton::addRunCommands(app, exit_code);
    baton::addBatonCommands(app, exit_code);
    baton::addControllerCommand(app, exit_code);
    baton::addOperateCommands(app, exit_code);
    baton::addParamCommand(app, exit_code);
    baton::addReplayCommand(app, exit_code);
    baton::addBagCommand(app, exit_code);
    baton::addBranchCommand(app, exit_code);
    baton::addRerunCommand(app, exit_code);
    baton::addKillsCommand(app, exit_code);
    baton::addMetricsCommand(app);
    baton::addShadowCommand(app);
    baton::addFiguresCommand(app, exit_code);
    baton::addModelCommand(app, exit_code);
    baton::addLawsCommand(app);
    const baton::ExitCode parsed = baton::runCommand(app, argc, argv);
    return parsed == baton::ExitCode::kOk ? exit_code : parsed;
  });
}
