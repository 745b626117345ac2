/// `baton shadow`: what each controller of a recorded run would have done.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addShadowCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
