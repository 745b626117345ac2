/// `baton param`: the parameters that the controllers of a run have now, and other values for them.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addParamCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
