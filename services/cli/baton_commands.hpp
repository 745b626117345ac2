/// `baton controllers` and `baton swap`: who holds the baton, what the others would do with it, and handing it over.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addBatonCommands(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
