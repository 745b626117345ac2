/// `baton shadow`: what each controller of a recorded run would have done.
#pragma once

#include <CLI/CLI.hpp>

namespace baton {

void addShadowCommand(CLI::App& app);

}  // namespace baton
