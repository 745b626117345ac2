/// The part of a law that comes from the robot's model, and the ways an experiment makes it wrong on purpose.
#pragma once

#include "base/types.hpp"
#include "control/parameters.hpp"
#include "robot/model.hpp"

namespace baton {

/// Which terms of tau = B(q) y + n(q, qd), n = C qd + g, a law uses.
enum class ModelUse {
  kFull,
  kIgnoreInertia,  // tau = y + n
  kIgnoreBias,     // tau = B y
  kIgnoreBoth      // tau = y
};

/// Parameter `model`: full, ignore_inertia, ignore_bias or ignore_both.
[[nodiscard]] ParameterSpec modelUseParameter();
[[nodiscard]] ModelUse modelUse(const ParameterValues& values);

/// Parameter `mass_scale`: the law believes in links this many times as heavy as the robot file says.
[[nodiscard]] ParameterSpec massScaleParameter();
/// The model with every link's mass, first moment and inertia multiplied by `mass_scale`: B, C and g scale alike.
[[nodiscard]] RobotModel believedModel(const RobotModel& model, const ParameterValues& values);

/// tau = B y + n, less what `use` ignores. q, qd, y, tau: n entries.
void computedEffort(const RobotModel& model, ModelUse use, const JointVector& q, const JointVector& qd,
                    const JointVector& y, JointVector& tau) noexcept;

}  // namespace baton
