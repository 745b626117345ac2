/// Recordings to be measured with.
#pragma once

#include <cstdint>
#include <string>

namespace baton::bench {

inline constexpr const char* kTopic = "ticks";
inline constexpr const char* kType = "baton::bench::Tick";

struct RecordingPlan {
  std::uint64_t messages = 0;
  std::uint64_t period_ns = 1'000'000;  // from one to the next
  std::size_t payload_bytes = 100;
};

/// One topic; the payloads do not compress.
void writeRecording(const std::string& file, const RecordingPlan& plan);

}  // namespace baton::bench
