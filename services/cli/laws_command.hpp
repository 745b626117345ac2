/// `baton laws`: the laws a controller can run and their parameters, from the laws' own declarations.
#pragma once

#include <CLI/CLI.hpp>

namespace baton {

void addLawsCommand(CLI::App& app);

}  // namespace baton
