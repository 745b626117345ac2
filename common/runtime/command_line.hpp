/// What the command lines of all programs share: the options that place a process in DDS, and how a wrong line is told.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "base/error.hpp"
#include "dds/types.hpp"
#include "dds/wall_clock.hpp"
#include "runtime/scheduling.hpp"

namespace baton {

/// Parses. Returns false after printing the help that was asked for. Throws UsageError for a line that is wrong.
[[nodiscard]] bool parseCommandLine(CLI::App& app, int argc, const char* const* argv);

/// Parses a line that begins with a command, which runs as it is met, or prints the help that was asked for. Throws
/// UsageError for a line that is wrong: in which command, and what; of a damaged recording also what to do.
void runCommand(CLI::App& app, int argc, const char* const* argv);

/// --cell: refuses a name that is not 1 to 31 of A-Z a-z 0-9 _ -, as it becomes part of a file's name and of a DDS
/// partition.
CLI::Option* addCell(CLI::App& app, std::string& cell);
/// --domain: 0 to 232.
CLI::Option* addDomain(CLI::App& app, int& domain);
/// --transport: udp or shm.
CLI::Option* addTransport(CLI::App& app, dds::Transport& transport);
/// --clock-offset: the clock of a run that has begun, so that this process counts the same time.
CLI::Option* addClock(CLI::App& app, dds::WallClock& clock);
/// What is recorded may be of years.
inline constexpr double kMaxReplayRate = 1e9;
/// A rate as people write it: seconds per second, up to `highest`, or max, which is 0. Throws UsageError, saying `what`
/// it was for.
[[nodiscard]] double parseRate(const std::string& what, const std::string& text, double highest);
/// For numbers that are finite and not negative; CLI's own check lets NaN pass.
[[nodiscard]] CLI::Validator notNegative();
/// For counts: whole numbers from 1 on.
[[nodiscard]] CLI::Validator atLeastOne();
/// For whole numbers, both ends included.
[[nodiscard]] CLI::Validator wholeBetween(std::int64_t low, std::int64_t high);
/// For numbers, both ends included.
[[nodiscard]] CLI::Validator between(double low, double high);
/// --fifo and --cpus.
void addScheduling(CLI::App& app, Scheduling& scheduling);

}  // namespace baton
