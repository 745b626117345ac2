/// `baton replay`: publishes a recording again. The replayer does it and knows the options; this starts it.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addReplayCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
