#include "replay_command.hpp"

#include <string>
#include <vector>

#include "become.hpp"

namespace baton {

void addReplayCommand(CLI::App& app, ExitCode& /*exit_code*/) {
  CLI::App* command = app.add_subcommand("replay", "publish a recording again: the same bytes, in their rhythm");
  command->prefix_command();  // everything behind the name is for the replayer, --help too
  command->set_help_flag();
  command->callback([command] {
    std::vector<std::string> arguments{"baton replay"};  // what its help calls it
    const std::vector<std::string> rest = command->remaining();
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    become("baton-replayer", std::move(arguments));
  });
}

}  // namespace baton
