/// How a time was distributed, counted in buckets: log-linear, as in HdrHistogram (G. Tene). Below 128 every nanosecond
/// has a bucket of its own; above, each power of two is divided into 64, so a bucket is at most 1/64 of its values
/// wide. Memory is fixed and recording is a few instructions: made for a loop that must not allocate, lock or wait.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace baton {

class Histogram {
 public:
  /// From here on (4.6 minutes) a value has no bucket of its own: it is known by count(), mean() and max() alone.
  static constexpr int kLimitBits = 38;
  static constexpr std::int64_t kLimit = std::int64_t{1} << kLimitBits;

  /// Counts a value [ns, or any other unit]; below 0 it counts as 0.
  void record(std::int64_t value) noexcept;

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Exact; 0 when nothing was recorded.
  [[nodiscard]] std::int64_t min() const noexcept { return count_ == 0 ? 0 : min_; }
  [[nodiscard]] std::int64_t max() const noexcept { return max_; }
  [[nodiscard]] double mean() const noexcept;
  /// The smallest value that at least the share p of all values does not exceed (nearest rank), p in 0..1. It is the
  /// middle of that value's bucket, so exact below 128 and at most 1/128 off above; never outside min() and max().
  /// 0 when nothing was recorded.
  [[nodiscard]] std::int64_t quantile(double p) const noexcept;

 private:
  static constexpr int kPrecisionBits = 6;
  static constexpr std::size_t kPerOctave = std::size_t{1} << kPrecisionBits;
  static constexpr std::size_t kBuckets = (kLimitBits - kPrecisionBits + 1) * kPerOctave;
  [[nodiscard]] static std::size_t bucketOf(std::int64_t value) noexcept;
  [[nodiscard]] static std::int64_t middleOf(std::size_t bucket) noexcept;

  std::array<std::uint64_t, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  std::int64_t sum_ = 0;
  std::int64_t min_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace baton
