/// `baton rerun`: does a recorded run again and says whether the bytes are the same.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addRerunCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
