/// `baton up`, `run`, `down`, `logs`: the life of a run.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "run_session.hpp"

namespace baton {

void addRunCommands(CLI::App& app, ExitCode& exit_code);

/// Runs a scenario to its end with progress on the terminal; for `run` and `demo`.
[[nodiscard]] ExitCode runToTheEnd(RunSession& session);

/// --cell and --domain, for every command that speaks to a run.
void addCellOptions(CLI::App& command, std::string& cell, int& domain);

}  // namespace baton
