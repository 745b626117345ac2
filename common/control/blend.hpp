/// The bumpless part of a swap of laws: the torque that the new law leaves unexplained at the swap fades away smoothly.
/// The plant owns it, so no law needs to know that there was a swap.
#pragma once

#include <cstdint>

#include "base/state_archive.hpp"
#include "base/types.hpp"

namespace baton {

/// Quintic fade sigma(s) from 1 at s = 0 to 0 at s = 1, with zero first and second derivatives at both ends, so the
/// torque's rate and the jerk do not jump either. Outside [0, 1] it stays at 1 and at 0.
[[nodiscard]] inline double quinticFade(double s) noexcept {
  if (s <= 0.0) return 1.0;
  if (s >= 1.0) return 0.0;
  return 1.0 - s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

/// tau(k) = tau_new(k) + sigma((k - K) / duration) r0,  r0 = tau_old(K) - tau_new(K), both for the same step K.
/// When a fade is still running at K, tau_old includes it: start() replaces what is left of it and nothing jumps.
class BumplessBlend {
 public:
  /// @param K  step of the swap.  @param duration_steps  steps until the fade is over; 0 means no fade.
  /// @param r0 n entries [N m or N].
  void start(std::uint64_t K, std::uint64_t duration_steps, const JointVector& r0) noexcept {
    start_ = K;
    duration_ = duration_steps;
    r0_ = r0;
  }

  /// Adds this step's remainder to tau (n entries); does nothing before K and once the fade is over.
  void add(std::uint64_t step, JointVector& tau) const noexcept {
    if (isActive(step)) tau += quinticFade(static_cast<double>(step - start_) / static_cast<double>(duration_)) * r0_;
  }

  void archive(StateArchive& state) noexcept { state(start_, duration_, r0_); }

  [[nodiscard]] bool isActive(std::uint64_t step) const noexcept { return step >= start_ && step - start_ < duration_; }

 private:
  std::uint64_t start_ = 0;
  std::uint64_t duration_ = 0;
  JointVector r0_;
};

}  // namespace baton
