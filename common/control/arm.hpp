/// The arm that is simulated: state, blend of torques after a swap, saturation, motion over a step, and the brake.
#pragma once

#include <cstdint>

#include "base/signals.hpp"
#include "control/blend.hpp"
#include "robot/kinematics.hpp"
#include "robot/model.hpp"

namespace baton {

struct ArmConfig {
  double step_s = 0.0;            // length of a control step
  int substeps = 1;               // of the integration within it
  std::uint64_t blend_steps = 0;  // over which the difference between two torques fades
  JointVector start_q;            // n entries [rad or m]
  JointVector start_qd;           // n entries [rad/s or m/s]
};

class Arm {
 public:
  /// `model` must outlive the arm.
  Arm(const RobotModel& model, const ArmConfig& config);

  [[nodiscard]] const RobotState& state() const { return state_; }

  /// Built into the plant for when nobody holds the baton: gravity held, every motion damped,
  /// tau = g(q) - kBrakeRate B(q) qd. Without friction and contact kinetic energy falls as exp(-2 kBrakeRate t).
  [[nodiscard]] JointVector brakeEffort() const;

  /// The difference r0 between what the joints would have felt and what they are given from step K on; it fades away.
  void blendFrom(std::uint64_t K, const JointVector& r0) { blend_.start(K, config_.blend_steps, r0); }
  /// `effort` plus what is left of the blend at this step.
  [[nodiscard]] JointVector blended(std::uint64_t step, const JointVector& effort) const;

  /// The effort that, blended at this step, keeps the joints' present torque.
  [[nodiscard]] JointVector holdingEffort(std::uint64_t step) const;

  /// Holds tau, cut to the joints' limits, over one step. Returns false, leaving the state as it was, when the motion
  /// stops being finite.
  [[nodiscard]] bool move(const JointVector& tau, const Contact& contact);

 private:
  void updateTip();

  static constexpr double kBrakeRate = 20.0;  // 1/s
  const RobotModel& model_;
  ArmConfig config_;
  RobotState state_;
  Kinematics kinematics_;
  BumplessBlend blend_;
};

}  // namespace baton
