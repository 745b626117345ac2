#include "time/pacer.hpp"

#include <algorithm>
#include <cmath>

namespace baton {

void Pacer::anchor(std::uint64_t step, std::int64_t now_ns) noexcept {
  anchor_step_ = step;
  anchor_ns_ = now_ns;
}

void Pacer::forgive(std::uint64_t step, std::int64_t now_ns, std::int64_t limit_ns) noexcept {
  if (const std::optional<std::int64_t> due = deadline(step); due && now_ns - *due > limit_ns) anchor(step, now_ns);
}

void Pacer::setRate(double rate, std::uint64_t step, std::int64_t now_ns) noexcept {
  rate_ = rate;
  anchor(step, now_ns);
}

std::optional<std::int64_t> Pacer::deadline(std::uint64_t step) const noexcept {
  if (rate_ <= 0.0) return std::nullopt;
  const double wait_ns = static_cast<double>(step - anchor_step_) * static_cast<double>(step_ns_) / rate_;
  constexpr double kForever_ns = 4e18;  // 127 years, still an int64
  return anchor_ns_ + std::llround(std::min(wait_ns, kForever_ns));
}

std::uint64_t Pacer::stepAt(std::int64_t now_ns) const noexcept {
  if (rate_ <= 0.0 || now_ns <= anchor_ns_) return anchor_step_;
  const double steps = static_cast<double>(now_ns - anchor_ns_) * rate_ / static_cast<double>(step_ns_);
  return anchor_step_ + static_cast<std::uint64_t>(std::min(steps, 9e18));
}

bool Pacer::isDue(std::uint64_t step, std::int64_t now_ns) const noexcept {
  const std::optional<std::int64_t> due = deadline(step);
  return !due || now_ns >= *due;
}

}  // namespace baton
