/// Where the links are and how they move: frames, the tip's pose and twist, Jacobians.
#pragma once

#include <array>

#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// Results of computeKinematics for one (q, qd); a workspace to reuse, it never allocates.
struct Kinematics {
  std::array<Pose, kMaxJoints + 1> X_WL;  // [0] the base frame, [i] the frame of link i, [n] the tip
  Pose X_WE;                              // tip pose
  Vector6 V_WE = Vector6::Zero();         // tip twist
  Jacobian J;                             // geometric: V_WE = J qd; 6 x n
  Vector6 Jdot_qd = Vector6::Zero();      // dJ/dt qd: the tip's acceleration at qdd = 0
};

/// Forward and differential kinematics (Siciliano et al. 2009, sec. 2.8 and 3.1). q, qd: n entries.
void computeKinematics(const RobotModel& model, const JointVector& q, const JointVector& qd, Kinematics& out) noexcept;

/// Tip pose alone.
[[nodiscard]] Pose tipPose(const RobotModel& model, const JointVector& q) noexcept;

/// ZYZ Euler angles (phi, theta, psi) of R, with theta in [0, pi] (eq. 2.19); phi and psi are in (-pi, pi], where a
/// hair beyond -pi counts as pi, so that rounding does not throw them from one end to the other. Where sin(theta) = 0
/// only phi + psi (theta = 0) or phi - psi (theta = pi) is defined: phi = 0 is returned.
[[nodiscard]] Vector3 zyzFromRotation(const Matrix3& R) noexcept;

/// T(phi) of omega = T(phi) d(phi)/dt for ZYZ angles (eq. 3.64); singular at sin(theta) = 0.
[[nodiscard]] Matrix3 zyzRateMatrix(const Vector3& zyz) noexcept;

/// Analytical Jacobian J_A = diag(I, T^-1) J for ZYZ angles (eq. 3.66), 6 x n. Where sin(theta) is below 1e-9, that is
/// zero but for rounding, T has no inverse: returns false and leaves J_A as it was.
[[nodiscard]] bool analyticalJacobian(const Kinematics& kinematics, Jacobian& J_A) noexcept;

/// The same with T^-1 damped where sin(theta) < 0.1, so that it exists everywhere and no rate of an angle exceeds 12
/// times the angular velocity: psi's rate is omega_u s / (s^2 + 0.05^2 (1 - (s / 0.1)^2)), s = sin(theta), instead of
/// omega_u / s, omega_u the part of omega that turns the tip's axis sideways (variable damping as in Chiaverini,
/// Siciliano, Egeland, IEEE Trans. Control Systems Technology (1994)). Where s is zero, phi is 0 as in zyzFromRotation.
[[nodiscard]] Jacobian dampedAnalyticalJacobian(const Kinematics& kinematics) noexcept;

/// Rotation by `angle_rad` about a unit vector (Rodrigues; Siciliano et al. 2009, eq. 2.25).
[[nodiscard]] Matrix3 rotationAbout(const Vector3& axis, double angle_rad) noexcept;

/// Rotation vector (axis x angle, angle in [0, pi]) of R [rad].
[[nodiscard]] Vector3 rotationVector(const Matrix3& R) noexcept;

}  // namespace baton
