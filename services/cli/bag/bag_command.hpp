/// `baton bag`: what is in recordings, whether it is whole, and what can be made of it.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addBagCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
