/// PD on the tip's pose through the transposed Jacobian: what operational_pd and compliance have in common. Their files
/// under laws/ give the equation in its context.
#pragma once

#include <memory>
#include <vector>

#include "control/law.hpp"

namespace baton {

/// tau = g(q) + J^T (Kp x~ - Kd J qd) with orientation error and Jacobian as the parameter `orientation` says:
///
/// zyz: differences of ZYZ angles, each the short way round, and the analytical Jacobian J_A, as in the report.
///   Where the tip's z axis is vertical (sin(theta) = 0; for the report's arm q1 = +-pi/2) J_A does not exist, and phi
///   and psi jump by pi across it. The arm is fit there; only its description is not. So the law never refuses: J_A is
///   damped where sin(theta) < 0.1 (dampedAnalyticalJacobian), and on the singularity itself phi is 0. The report's arm
///   turns its tip straight through the vertical, which theta alone feels, so damping changes nothing for it; what is
///   left is that theta's error, and the effort it makes, change sides at the vertical. Beyond it the error leads to a
///   mirrored orientation: from a little beyond the position's pull wins and brings the arm back, from farther (q1 = 2)
///   the arm comes to rest at an equilibrium that is not the goal, with L < 0.
/// rotation_vector: the rotation vector of R_d R^T and the geometric Jacobian. Nothing is singular, and the error is
///   the shortest turn to the goal; it jumps only where two turns are equally short, half a turn away.
[[nodiscard]] std::unique_ptr<Law> makeTipPd(const RobotModel& model, const ParameterValues& values);

/// kp and kd with these default gains, six numbers each, orientation, gravity, gravity_position and mass_scale.
[[nodiscard]] std::vector<ParameterSpec> tipPdParameters(std::vector<double> kp, std::vector<double> kd);

}  // namespace baton
