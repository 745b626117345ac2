/// `baton whatif`: what another law, or other values, would have commanded in a recorded run.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addWhatIfCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
