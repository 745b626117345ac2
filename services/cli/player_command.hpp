/// `baton player`: what is asked of a replay that goes on.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addPlayerCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
