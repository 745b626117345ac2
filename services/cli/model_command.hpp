/// `baton model`: kinematics and dynamics of a robot at one configuration, for comparing with other tools and by hand.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addModelCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
