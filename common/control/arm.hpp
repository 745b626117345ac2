/// The arm that is simulated: state, blend of torques after a swap, saturation, motion over a step, and the brake.
#pragma once

#include <cstdint>
#include <optional>

#include "base/signals.hpp"
#include "control/blend.hpp"
#include "robot/kinematics.hpp"
#include "robot/model.hpp"

namespace baton {

/// What the arm feels of the environment within a step, of which it hears at the step's start.
enum class Coupling {
  kDerivatives,  // the force at the start, followed by its derivatives as the tip moves
  kHeld,         // the force at the start, kept: half a step late on average, as damping of -K dt/2
  kLate          // the force of the step before, kept: damping of -3 K dt/2. The first step keeps its own
};
inline constexpr Coupling kCouplings[] = {Coupling::kDerivatives, Coupling::kHeld, Coupling::kLate};
[[nodiscard]] const char* toString(Coupling coupling);  // as scenarios call it

struct ArmConfig {
  double step_s = 0.0;   // length of a control step
  int substeps = 1;      // of the integration within it
  JointVector start_q;   // n entries [rad or m]
  JointVector start_qd;  // n entries [rad/s or m/s]
  Coupling coupling = Coupling::kDerivatives;
};

class Arm {
 public:
  /// `model` must outlive the arm.
  Arm(const RobotModel& model, const ArmConfig& config);

  /// Back to the start, at rest or not as the configuration says, without a blend.
  void reset();

  [[nodiscard]] const RobotState& state() const { return state_; }

  /// Built into the plant for when nobody holds the baton: gravity held, every motion damped,
  /// tau = g(q) - kBrakeRate B(q) qd. Without friction and contact kinetic energy falls as exp(-2 kBrakeRate t).
  [[nodiscard]] JointVector brakeEffort() const;

  /// The difference r0 between what the joints would have felt and what they are given from step K on; it fades away
  /// within so many steps, 0 for at once.
  void blendFrom(std::uint64_t K, std::uint64_t steps, const JointVector& r0) { blend_.start(K, steps, r0); }
  /// What is left of the blend at this step.
  [[nodiscard]] JointVector residual(std::uint64_t step) const;
  /// `effort` plus that.
  [[nodiscard]] JointVector blended(std::uint64_t step, const JointVector& effort) const;

  /// The effort that, blended at this step, keeps the joints' present torque.
  [[nodiscard]] JointVector holdingEffort(std::uint64_t step) const;

  /// Holds tau, cut to the joints' limits, over one step that begins with this contact. Returns false, leaving the
  /// state as it was, when the motion runs away.
  [[nodiscard]] bool move(const JointVector& tau, const Contact& contact);

  /// State, blend and what the coupling remembers; the tip follows from them.
  void archive(StateArchive& state) noexcept;

 private:
  void updateTip();
  [[nodiscard]] Contact felt(const Contact& contact) const;

  static constexpr double kBrakeRate = 20.0;  // 1/s
  const RobotModel& model_;
  ArmConfig config_;
  RobotState state_;
  Kinematics kinematics_;
  BumplessBlend blend_;
  std::optional<Vector6> h_e_before_;  // at the start of the step before
};

}  // namespace baton
