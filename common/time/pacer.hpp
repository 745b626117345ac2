/// When a step may begin, on the wall clock: as fast as possible, or at a factor of real time. The clock is the
/// caller's: `now_ns` is any steady nanosecond count.
#pragma once

#include <cstdint>
#include <optional>

namespace baton {

/// Slower than that looks like a standstill.
inline constexpr double kMinRate = 1e-7;
/// Faster than any simulation here: `max` is meant.
inline constexpr double kMaxRate = 1000.0;

class Pacer {
 public:
  /// @param rate simulated seconds per second; 0 means no pacing.
  Pacer(std::int64_t step_ns, double rate) noexcept : step_ns_(step_ns), rate_(rate) {}

  /// From here on: step `step` is due now. Called at the start, after a pause and when the rate changes, so that time
  /// lost is never caught up in a rush.
  void anchor(std::uint64_t step, std::int64_t now_ns) noexcept;
  /// After a stall the motion goes on at its rate from here; a delay shorter than `limit_ns` is caught up.
  void forgive(std::uint64_t step, std::int64_t now_ns, std::int64_t limit_ns) noexcept;
  void setRate(double rate, std::uint64_t step, std::int64_t now_ns) noexcept;
  [[nodiscard]] double rate() const noexcept { return rate_; }

  /// When `step` may begin; nothing when there is no pacing.
  [[nodiscard]] std::optional<std::int64_t> deadline(std::uint64_t step) const noexcept;
  /// The step that is due now: the inverse of deadline(). The anchor's own step before that, and without pacing.
  [[nodiscard]] std::uint64_t stepAt(std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool isDue(std::uint64_t step, std::int64_t now_ns) const noexcept;

 private:
  std::int64_t step_ns_;
  double rate_;
  std::uint64_t anchor_step_ = 0;
  std::int64_t anchor_ns_ = 0;
};

}  // namespace baton
