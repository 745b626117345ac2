/// `baton figures`: every figure of the report, run, drawn, and held against theory on one page.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addFiguresCommand(CLI::App& app, ExitCode& exit_code);

}  // namespace baton
