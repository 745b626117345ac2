/// `baton record`: what a run's recorder does, and how it stands.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addRecordCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
