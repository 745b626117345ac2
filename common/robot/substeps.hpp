/// How short the sub-steps of integrateStep() have to be: friction and whatever the tip touches make fast poles.
#pragma once

#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// What pulls the arm back while the torque is held: a damping at the joints and a spring and a damper at the tip.
struct StiffTerms {
  JointVector joint_damping;                // n entries [N m s/rad or N s/m]
  Matrix3 tip_stiffness = Matrix3::Zero();  // symmetric, in W [N/m]
  Matrix3 tip_damping = Matrix3::Zero();    // likewise [N s/m]
};

/// The slope of a joint's friction at rest, where it is steepest: viscous + coulomb / coulomb_velocity.
[[nodiscard]] JointVector frictionSlope(const RobotModel& model);

struct SubstepNeed {
  double pole_per_s = 0.0;  // magnitude of the pole that needs the shortest sub-step
  double longest_s = 0.0;   // sub-step with which RK4 is stable for all poles; infinity without a pole
  /// Sub-steps of a step; a whole number.
  [[nodiscard]] double substeps(double step_s) const;
};

/// Poles of B(q) qdd + (D + J^T D_tip J) qd + J^T K_tip J q = 0, the motion about rest at q without gravity, and RK4's
/// region of stability for each: |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 at z = pole x sub-step, 2.785 on the real axis
/// and 2.828 on the imaginary one (Hairer, Wanner (1996), sec. IV.2). Allocates.
[[nodiscard]] SubstepNeed substepNeed(const RobotModel& model, const JointVector& q, const StiffTerms& terms);

}  // namespace baton
