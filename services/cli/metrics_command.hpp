/// `baton metrics`: how well a recorded run went, in numbers.
#pragma once

#include <CLI/CLI.hpp>

namespace baton {

void addMetricsCommand(CLI::App& app);

}  // namespace baton
