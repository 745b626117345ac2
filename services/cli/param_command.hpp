/// `baton param`: the parameters that the controllers of a run have now.
#pragma once

#include <CLI/CLI.hpp>

namespace baton {

void addParamCommand(CLI::App& app);

}  // namespace baton
