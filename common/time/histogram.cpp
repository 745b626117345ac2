#include "time/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace baton {

std::size_t Histogram::bucketOf(std::int64_t value) noexcept {
  // The leading 1 and the six bits behind it; how far they are shifted names the octave.
  const auto bits = static_cast<std::uint64_t>(value);
  const int shift = std::max(0, static_cast<int>(std::bit_width(bits)) - (kPrecisionBits + 1));
  return static_cast<std::size_t>(shift) * kPerOctave + static_cast<std::size_t>(bits >> shift);
}

std::int64_t Histogram::middleOf(std::size_t bucket) noexcept {
  const std::size_t shift = bucket < 2 * kPerOctave ? 0 : bucket / kPerOctave - 1;
  const std::size_t low = (bucket - shift * kPerOctave) << shift;
  return static_cast<std::int64_t>(low + ((std::size_t{1} << shift) >> 1));
}

void Histogram::record(std::int64_t value) noexcept {
  value = std::max<std::int64_t>(value, 0);
  if (value < kLimit) ++buckets_[bucketOf(value)];
  min_ = count_ == 0 ? value : std::min(min_, value);
  max_ = std::max(max_, value);
  sum_ += value;
  ++count_;
}

double Histogram::mean() const noexcept {
  return count_ == 0 ? 0.0 : static_cast<double>(sum_) / static_cast<double>(count_);
}

std::int64_t Histogram::quantile(double p) const noexcept {
  if (count_ == 0) return 0;
  const double share = std::clamp(p, 0.0, 1.0) * static_cast<double>(count_);
  const std::uint64_t rank = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::ceil(share)), 1, count_);
  if (rank == 1) return min_;
  if (rank == count_) return max_;
  std::uint64_t so_far = 0;
  const std::size_t last = bucketOf(std::min(max_, kLimit - 1));
  for (std::size_t bucket = bucketOf(std::min(min_, kLimit - 1)); bucket <= last; ++bucket) {
    so_far += buckets_[bucket];
    if (so_far >= rank) return std::clamp(middleOf(bucket), min_, max_);
  }
  return max_;  // among those without a bucket
}

}  // namespace baton
