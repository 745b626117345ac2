/// Motion of the arm over one control step: torque held, RK4 in sub-steps, contact force followed by its derivatives.
#pragma once

#include "base/signals.hpp"
#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// No joint of an arm moves so fast [rad/s or m/s]. Far enough below kLargestSignal that what follows from the state,
/// and the force of a stiff wall, is none that would be refused first.
inline constexpr double kFastestMotion = 1e6;

/// tau cut to each joint's effort limit. Returns how many joints were cut.
int saturateEffort(const RobotModel& model, JointVector& tau) noexcept;

/// Integrates (q, qd) over dt_s with classical RK4 in `substeps` equal sub-steps.
/// tau is held; the contact force at any instant is contact.h_e + df_dp (p - p0) + df_dv (v - v0), where p0 and v0 are
/// the tip's position and velocity at the start of the step (a held force would act as negative damping -K dt/2).
/// @return false when the motion runs away, faster than kFastestMotion; q and qd are then left as they were.
[[nodiscard]] bool integrateStep(const RobotModel& model, const JointVector& tau, const Contact& contact, double dt_s,
                                 int substeps, JointVector& q, JointVector& qd) noexcept;

}  // namespace baton
