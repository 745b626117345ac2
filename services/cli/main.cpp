// The command line people type.
#include <CLI/CLI.hpp>
#include <functional>

#include "commands.hpp"
#include "mcap/reader.hpp"
#include "opening_progress.hpp"
#include "runtime/command_line.hpp"
#include "runtime/log.hpp"
#include "runtime/run.hpp"

int main(int argc, char** argv) {
  static baton::OpeningProgress openings;
  return baton::runGuarded("baton", [&] {
    baton::setUpLog("baton");
    baton::mcap::setOpeningSink(std::ref(openings));
    baton::ExitCode exit_code = baton::ExitCode::kOk;
    CLI::App app{
        "Baton, a control laboratory on DDS: robot, wall, trajectory and controllers are processes of their own;\n"
        "controllers hand over live, everything is recorded. Every command has --help.\n"
        "Exit codes: 0 done, 1 tried and failed, 2 wrong input, 3 something needed is missing or taken,\n"
        "4 the run was stopped by its own policy, 130 interrupted."};
    app.name("baton");
    app.set_version_flag("--version", "baton " BATON_VERSION " (" BATON_COMPILER ", " BATON_FLAGS ")");
    app.require_subcommand(1);
    baton::addCommands(app, exit_code);
    baton::runCommand(app, argc, argv);
    return exit_code;
  });
}
