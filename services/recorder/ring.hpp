/// The latest samples of a run, in memory: those of the last so many steps and no more than so many bytes. What has
/// become older is kept as well where late joiners would be given it (events, the latest status of each writer): it
/// says what was decided before, and how things stood. Nothing is allocated for a sample; of the memory, only what has
/// been used once is taken from the system.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "runtime/latched.hpp"

namespace baton {

class Ring {
 public:
  struct Sample {
    std::size_t stream = 0;
    std::uint64_t sequence = 0;
    std::int64_t log_time_ns = 0;
    std::int64_t source_timestamp_ns = 0;
    std::uint64_t step = 0;         // of the run, when it came
    std::uint64_t lost_before = 0;  // samples of its writer that should have come between the one before and this
    std::size_t latched = 0;        // how many of its writer's samples are kept when they have grown old
    const dds::TopicFacts* facts = nullptr;  // of a topic of Baton's
    bool is_left_out = false;                // came in a pause: kept only for what begins later
    std::span<const std::byte> payload;
  };

  Ring(std::uint64_t steps, std::size_t max_bytes);

  /// What is older than `steps` before this sample goes, and more when there is no room. A sample larger than the whole
  /// ring is not kept; returns false then.
  bool push(const Sample& sample);
  /// All samples that are not older than the ring and not left out, oldest first: log times never decrease.
  void forEach(const std::function<void(const Sample&)>& callback) const;
  /// Those that are older and kept. Their bytes lie next to them, not in `payload`.
  [[nodiscard]] const LatchedSamples<Sample>& older() const { return older_; }
  void clear();

  /// When the first one of those came that are not older than the ring; nothing when there is none.
  [[nodiscard]] std::optional<std::uint64_t> firstStep() const;
  [[nodiscard]] std::size_t samples() const { return count_ - left_out_ + older_.size(); }
  [[nodiscard]] std::size_t bytes() const { return used_ + older_.bytes(); }

 private:
  void popOldest();
  [[nodiscard]] Sample sampleAt(std::size_t offset) const;
  [[nodiscard]] static std::size_t sizeOf(const Sample& sample);

  std::uint64_t steps_;
  std::size_t capacity_;
  std::unique_ptr<std::byte[]> memory_;
  // Records of head and payload lie behind each other from first_ to next_; the last of a round may be followed by
  // room too small for the next one, which begins at 0 again then, and end_ says where.
  std::size_t first_ = 0;
  std::size_t next_ = 0;
  std::size_t end_ = 0;
  std::size_t count_ = 0;
  std::size_t left_out_ = 0;  // of the count
  std::size_t used_ = 0;
  LatchedSamples<Sample> older_;
};

}  // namespace baton
