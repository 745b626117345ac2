/// A run with a recorder, beside which processes that are no part of it publish as fast as they are told; and what of
/// it the recording holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "programs.hpp"

namespace baton::bench {

struct Load {
  int writers = 4;     // processes
  int topics = 2;      // each writes all of them in turn
  int bytes = 100;     // of a payload
  double rate = 50e3;  // messages a second, of all writers together
  double seconds = 5.0;
};

/// One writer's samples on all topics.
struct WriterCount {
  std::string name;
  std::uint64_t sent = 0;
  std::uint64_t recorded = 0;  // found in the file, in order, each with the bytes of its number
};

struct Recorded {
  double asked = 0.0;       // messages a second
  double sent_per_s = 0.0;  // from the first writer's begin to the last one's end
  std::vector<WriterCount> writers{};
  bool is_complete = false;  // by the recording's own certificate
  double recorder_MB = 0.0;  // of memory

  [[nodiscard]] std::uint64_t lost() const;
  /// Nothing is lost, and the writers have kept to what they were asked for.
  [[nodiscard]] bool isKept() const;
};

/// Runs plant, environment, trajectory and one controller at a crawl, so that nearly all there is to record is the
/// load.
/// @param file  of the recording; replaced.
/// Throws UnavailableError when the run or a writer fails.
[[nodiscard]] Recorded recordUnder(const Load& load, const std::filesystem::path& file, Programs& programs);

}  // namespace baton::bench
