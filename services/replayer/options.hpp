/// What to replay, and how: the replayer's command line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dds/types.hpp"

namespace baton {

struct ReplayOptions {
  std::string file;
  int domain = 0;
  std::string cell = "replay";  // a partition of its own, so that a running cell is not disturbed
  std::string run;              // never empty once parsed
  dds::Transport transport = dds::Transport::kUdp;
  std::vector<std::string> topics;           // recorded names; all when empty
  std::map<std::string, std::string> remap;  // recorded name to the name published
  double rate = 1.0;                         // recorded seconds per second; 0 for as fast as readers take it
  std::optional<double> from_s;              // log time from the recording's first message; from its start
  std::optional<double> to_s;                // to its end
  std::size_t wait_for = 0;                  // reading processes on every topic before the first message
  bool json = false;
};

/// Throws UsageError; prints help and returns false for --help.
[[nodiscard]] bool parseReplayOptions(int argc, const char* const* argv, ReplayOptions& options);

}  // namespace baton
