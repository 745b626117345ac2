/// Logging, set up once a process: lines for a person at three in the morning, on standard error. And reading the logs
/// of other processes, to tell why one of them ended.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace baton {

/// Lines look like "03:15:12.345678 warning plant: step=1200 ...". The DDS product's own log goes the same way.
void setUpLog(const std::string& name);

/// The last lines of a log, indented; empty when it cannot be read.
[[nodiscard]] std::string lastLines(const std::filesystem::path& log, std::size_t count);
/// Writes them to our own.
void logLastLines(const std::filesystem::path& log, std::size_t count);
/// The last line of a log that tells of an error, its last line when none does.
[[nodiscard]] std::string lastError(const std::filesystem::path& log);

}  // namespace baton
