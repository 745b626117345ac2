/// `baton whatif`: what another law, or other values, would have commanded in a recorded run.
#pragma once

#include <CLI/CLI.hpp>

namespace baton {

void addWhatIfCommand(CLI::App& app);

}  // namespace baton
