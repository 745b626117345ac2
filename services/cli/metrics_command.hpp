/// `baton metrics`: how well a recorded run went, in numbers.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addMetricsCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
