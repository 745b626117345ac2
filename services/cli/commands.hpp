/// Every command there is.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

/// In the order in which --help lists them. `exit_code` is what the one that runs makes of it.
void addCommands(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
