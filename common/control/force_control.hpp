/// A PI loop on the contact force around a loop on the tip's position: what force_pi and parallel_force_position have
/// in common. Their files under laws/ give the equations.
#pragma once

#include <memory>
#include <vector>

#include "control/law.hpp"

namespace baton {

/// tau = B y + n + J^T h_e,   y = J_P^-1 Md^-1 (-Kd x' + Kp (x_0 + x_F - x) - Md Jdot_P qd),
/// x_F = Kf (f_d - f_e) + w,   w' = Ki (f_d - f_e).
enum class ForceLoop {
  kAlone,          // x_0 = 0; a new run starts with x_F = x
  kAroundPosition  // x_0 = x_d; a new run starts with w = 0
};

/// Handover: w takes the value that gives the tip the acceleration it had; with three joints, away from singularities,
/// the effort then goes on where it was.
/// Anti-windup: w waits while its next increment would ask more of a joint whose limit cut the last effort
/// (control/anti_windup.hpp). In any other direction it goes on, so it can lead back out of the limit.
[[nodiscard]] std::unique_ptr<Law> makeForceControl(ForceLoop loop, const RobotModel& model,
                                                    const ParameterValues& values);

/// md, kd, kp, kf, ki, mass_scale and null_space_damping, with the report's gains, which both laws have.
[[nodiscard]] std::vector<ParameterSpec> forceControlParameters();

}  // namespace baton
