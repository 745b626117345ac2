/// What traffic to record, and how: the command line of `baton record traffic`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/scenario.hpp"
#include "topic_selection.hpp"

namespace baton {

struct TrafficOptions {
  std::string out;
  bool overwrite = false;
  int domain = 0;
  std::vector<std::string> interfaces;  // names or IPv4 addresses; empty: all of this machine
  std::vector<std::string> partitions;  // patterns; empty: all, and writers that set none
  TopicSelection selection;
  RecordingConfig recording;         // of this: compression, parts (in ms instead of steps) and limits
  std::optional<double> duration_s;  // empty: until a signal
  std::uint64_t max_messages = 0;    // 0: no limit
  bool json = false;
};

/// Throws UsageError; prints help and returns false for --help.
[[nodiscard]] bool parseTrafficOptions(int argc, const char* const* argv, TrafficOptions& options);

/// What readers match: the patterns, and "" where one of them stands for no partition as well.
[[nodiscard]] std::vector<std::string> readPartitions(const std::vector<std::string>& patterns);

/// Whether a reader in these would be matched, as DDS has it: either side may be a pattern.
[[nodiscard]] bool isInPartitions(const std::vector<std::string>& of_writer, const std::vector<std::string>& read);

}  // namespace baton
