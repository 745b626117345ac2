/// The part of a law that comes from the robot's model, and the ways an experiment makes it wrong on purpose.
#pragma once

#include <vector>

#include "base/signals.hpp"
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

/// tau = B y + n + J^T h_e read backwards: the y behind the effort that was applied, for laws that receive the baton.
/// Returns false, leaving y as it was, when B cannot be factorised or the result is not finite.
[[nodiscard]] bool appliedAcceleration(const RobotModel& model, const RobotState& state, const Vector6& h_e,
                                       JointVector& y) noexcept;

/// The gravity term of PD laws: at the measured position, none, or fixed at one position.
class GravityCompensation {
 public:
  GravityCompensation(const RobotModel& believed, const ParameterValues& values);

  /// @param[out] g  n entries [N m or N].
  void effort(const RobotModel& believed, const JointVector& q, JointVector& g) const noexcept;

 private:
  bool follows_position_;
  JointVector fixed_;  // zero unless gravity is fixed
};

/// Its parameters, `gravity` and `gravity_position`.
[[nodiscard]] std::vector<ParameterSpec> gravityParameters();

}  // namespace baton
