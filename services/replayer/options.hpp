/// What to replay, and how: the replayer's command line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dds/interfaces.hpp"
#include "dds/types.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/recording_range.hpp"
#include "runtime/scheduling.hpp"

namespace baton {

struct ReplayOptions {
  RecordingWish recording;
  std::string file;  // what of it is named, for people
  int domain = 0;
  std::string cell = "replay";           // a partition of its own, so that a running cell is not disturbed
  std::string run;                       // never empty once parsed
  std::optional<std::string> partition;  // heard there as well; empty: where listeners set none
  dds::Transport transport = dds::Transport::kUdp;
  std::vector<std::string> interfaces{dds::kLoopback};  // names or IPv4 addresses; "all": of this machine
  std::vector<std::string> topics;                      // recorded names; all when empty
  std::map<std::string, std::string> remap;             // recorded name to the name published
  double rate = 1.0;                                    // recorded seconds per second; 0 for as fast as readers take it
  RangeWish range;
  bool without_latched = false;         // does not begin with what a late joiner would have been given
  std::optional<double> longest_gap_s;  // in which nothing was logged; what is longer is cut to that
  std::uint32_t passes = 1;             // through it; 0 without end
  bool starts_paused = false;
  std::size_t wait_for = 0;                   // reading processes on every topic before the first message
  std::vector<std::string> wait_for_readers;  // services that read at least one
  double overdue_us = 1000.0;                 // later messages are counted
  std::optional<double> max_late_us;          // a later one is a failure
  Scheduling scheduling;
  bool json = false;
};

/// Throws UsageError; prints help and returns false for --help.
[[nodiscard]] bool parseReplayOptions(int argc, const char* const* argv, ReplayOptions& options);

}  // namespace baton
