/// What the commands to a run that is up have in common: which cell, and which of its steps.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "cell_client.hpp"

namespace baton {

struct CellTarget {
  std::string cell = "lab";
  int domain = 0;
  bool json = false;
};

/// A command with --cell, --domain and --json. `target` must outlive it.
CLI::App* addCellCommand(CLI::App& app, CellTarget& target, const char* name, const char* help);

/// How the run stands; throws UnavailableError when its plant says nothing.
[[nodiscard]] msg::SimStatus simStatus(CellClient& client);

/// The value of --at: on the wire 0 stands for no step in particular. Throws UsageError.
[[nodiscard]] std::uint64_t stepToCome(std::uint64_t step);

/// --at-time [s], the same as the option `at` in another unit: from 0 to 1e9, so that its step is a number.
void addAtTime(CLI::App& command, std::optional<double>& at_s, CLI::Option* at);

/// The value of --at-time [s]: the step nearest to a time of the run. Throws UsageError.
[[nodiscard]] std::uint64_t stepAt(CellClient& client, double time_s);

}  // namespace baton
