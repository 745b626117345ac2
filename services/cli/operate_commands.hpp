/// `baton status`, `sim`, `record`: what an operator asks of a run that is up.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addOperateCommands(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
