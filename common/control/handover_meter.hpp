/// What a handover did to the arm, measured step by step from its first step on: how fast the torques changed, how far
/// the contact force moved, what energy the blend put in. The plant owns it; nothing here acts on the arm.
#pragma once

#include <cstdint>

#include "base/state_archive.hpp"
#include "base/types.hpp"

namespace baton {

/// One step of the arm under a handover. Joint vectors have n entries.
struct HandoverStep {
  JointVector tau_before;  // what the joints felt over the step before [N m or N]
  JointVector tau;         // and over this one, after saturation
  JointVector residual;    // the part of this step's torque that the blend added, sigma(k) r0
  JointVector dq;          // q(k + 1) - q(k) [rad or m]
  Vector3 f_e;             // force of the tip on the environment at the step's start [N]
};

struct HandoverMeasure {
  std::uint64_t at_step = 0;          // K
  std::uint64_t steps = 0;            // measured
  JointVector max_effort_rate;        // largest |tau(k) - tau(k - 1)| / step_s of each joint [N m/s or N/s]
  std::uint64_t rate_limit_hits = 0;  // how often, over joints and steps, it was above the limit
  double peak_force_deviation = 0.0;  // largest |f_e(k) - f_e(K)| [N]
  double blend_energy = 0.0;  // sum of residual(k) . dq(k): the work of the blend's torque, held over each step [J]
};

class HandoverMeter {
 public:
  /// @param effort_rate_limit  n entries [N m/s or N/s].
  HandoverMeter(double step_s, const JointVector& effort_rate_limit);

  /// From step K on, for so many steps, one at least. What was being measured is forgotten.
  void start(std::uint64_t K, std::uint64_t steps) noexcept;
  void stop() noexcept { left_ = 0; }
  [[nodiscard]] bool isRunning() const noexcept { return left_ > 0; }

  /// The next step; does nothing unless isRunning().
  void add(const HandoverStep& step) noexcept;

  /// So far, or of the last time it ran.
  [[nodiscard]] const HandoverMeasure& measure() const noexcept { return measure_; }

  void archive(StateArchive& state) noexcept;

 private:
  double step_s_;
  JointVector limit_;
  std::uint64_t left_ = 0;  // steps still to be measured
  Vector3 f_K_ = Vector3::Zero();
  HandoverMeasure measure_;
};

}  // namespace baton
