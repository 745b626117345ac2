/// `baton bag`: what is in a recording, and whether it is whole.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addBagCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
