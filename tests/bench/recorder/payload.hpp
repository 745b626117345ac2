/// What the writers of the bench send, and what is therefore to be found in the recording.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "base/splitmix64.hpp"

namespace baton::bench {

inline constexpr const char* kLoadType = "bench::Load";  // of which Baton has no IDL
inline constexpr std::size_t kMinPayload = 16;           // the header of CDR and the number

[[nodiscard]] inline std::string loadTopic(int index) { return "load_" + std::to_string(index); }

/// Payloads of one length: each carries the number of its sample on its topic, from 1; the rest is noise, so that no
/// compressor helps.
class Payloads {
 public:
  explicit Payloads(std::size_t bytes) : payload_(bytes) {
    payload_.at(1) = std::byte{1};  // plain CDR, little endian
  }

  [[nodiscard]] std::span<const std::byte> make(std::uint64_t number) {
    std::memcpy(payload_.data() + kNumberAt, &number, sizeof number);
    for (std::size_t at = kMinPayload; at < payload_.size(); at += sizeof random_) {
      const std::uint64_t word = splitmix(random_ += kSplitmixStep);
      std::memcpy(payload_.data() + at, &word, std::min(sizeof word, payload_.size() - at));
    }
    return payload_;
  }
  /// The number in a payload; 0 when it is too short to have one.
  [[nodiscard]] static std::uint64_t numberIn(std::span<const std::byte> payload) {
    std::uint64_t number = 0;
    if (payload.size() >= kMinPayload) std::memcpy(&number, payload.data() + kNumberAt, sizeof number);
    return number;
  }

 private:
  static constexpr std::size_t kNumberAt = 4;
  std::vector<std::byte> payload_;
  std::uint64_t random_ = 0;
};

}  // namespace baton::bench
