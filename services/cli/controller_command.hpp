/// `baton controller start` and `stop`: controllers that come and go while the run goes on.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addControllerCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
