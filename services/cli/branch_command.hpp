/// `baton branch`: goes on from a step of a recorded run, with a change or without one.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addBranchCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
