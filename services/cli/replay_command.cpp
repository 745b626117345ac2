#include "replay_command.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "runtime/paths.hpp"

namespace baton {

void addReplayCommand(CLI::App& app, ExitCode& /*exit_code*/) {
  CLI::App* command = app.add_subcommand("replay", "publish a recording again: the same bytes, in their rhythm");
  command->prefix_command();  // everything behind the name is for the replayer, --help too
  command->set_help_flag();
  command->callback([command] {
    const std::string program = siblingProgram("baton-replayer");
    std::vector<std::string> arguments{"baton replay"};  // what its help calls it
    const std::vector<std::string> rest = command->remaining();
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    // It takes this process's place, and so its signals and its exit code are the replayer's.
    execv(program.c_str(), argv.data());
    throw UnavailableError("cannot start " + program + ": " + std::strerror(errno));
  });
}

}  // namespace baton
