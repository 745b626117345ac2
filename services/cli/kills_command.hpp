/// `baton kills`: kills processes of runs at seeded steps and checks what becomes of the runs.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addKillsCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
