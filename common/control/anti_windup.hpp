/// Anti-windup by conditional integration: a law's integral must not push further where a joint cannot follow. The
/// limits come from the robot's model, and what became of the last effort from the state the plant reports.
#pragma once

#include <cmath>

#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// Where a joint's limit cut the law's last effort: 1 or -1 in the direction of the cut, 0 for a joint that got what
/// was asked. Only what the plant reports at the limit counts as cut, so the remainder that fades out after a handover,
/// which also sets the applied effort apart from the commanded one, does not stop an integral.
/// @param commanded    the law's effort of the step before; no entries when there is none.
/// @param tau_applied  what the plant made of it.
[[nodiscard]] inline JointVector cutDirections(const RobotModel& model, const JointVector& commanded,
                                               const JointVector& tau_applied) noexcept {
  JointVector cut = JointVector::Zero(model.size());
  for (Eigen::Index i = 0; i < commanded.size(); ++i) {
    const double applied = tau_applied(i);
    const bool is_at_limit = std::abs(applied) >= model.joints[i].effort_limit;
    const double missing = (commanded(i) - applied) * std::copysign(1.0, applied);
    if (is_at_limit && missing > 0.0) cut(i) = std::copysign(1.0, applied);
  }
  return cut;
}

/// Whether a change of effort asks a joint that was cut for more of the same.
[[nodiscard]] inline bool pushesFurther(const JointVector& cut, const JointVector& change) noexcept {
  return (cut.array() * change.array() > 0.0).any();
}

}  // namespace baton
