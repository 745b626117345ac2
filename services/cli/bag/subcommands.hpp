/// The subcommands of `baton bag`, each in a file of its own.
#pragma once

#include <CLI/CLI.hpp>

#include "base/error.hpp"

namespace baton {

void addBagInfo(CLI::App& bag, ExitCode& exit_code);
void addBagHash(CLI::App& bag, ExitCode& exit_code);
void addBagVerify(CLI::App& bag, ExitCode& exit_code);
void addBagRecover(CLI::App& bag, ExitCode& exit_code);
void addBagMerge(CLI::App& bag, ExitCode& exit_code);
void addBagCut(CLI::App& bag, ExitCode& exit_code);
void addBagCat(CLI::App& bag, ExitCode& exit_code);
void addBagExport(CLI::App& bag, ExitCode& exit_code);
void addBagDiff(CLI::App& bag, ExitCode& exit_code);

}  // namespace baton
