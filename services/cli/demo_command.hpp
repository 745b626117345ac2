/// `baton demo`: the main job in one go, told to a person who sees Baton for the first time.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addDemoCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
