/// The RPP arm's kinematics and dynamics worked out by hand: a second opinion that shares no code with common/robot.
/// Five numbers carry its dynamics: B = diag(Ieq + m3 (r3 + q3)^2, M, m3).
#pragma once

#include <cmath>

#include "base/types.hpp"

namespace baton::test::rpp {

inline constexpr double kA1 = 0.4, kA2 = 0.4, kA3 = 0.46, kA4 = 0.15;  // m
inline constexpr double kGravity = 9.806;                              // m/s^2
inline constexpr double kSlidingMass = 1.1583;                         // M: links 2 and 3 [kg]
inline constexpr double kM3 = 0.0405;                                  // kg
inline constexpr double kR3 = 0.475;                                   // link 3's centre of mass at q3 = 0 [m]
inline constexpr double kS0 = 0.461459605270158;                       // first moment of links 1 and 2 [kg m]
inline constexpr double kIeq = 0.3291096875;                           // kg m^2

/// Reach L: distance of the tip from joint 1's axis.
inline double reach(const Vector3& q) { return kA2 + kA4 + q(2); }

inline Pose tipPose(const Vector3& q) {
  const double c = std::cos(q(0)), s = std::sin(q(0)), L = reach(q);
  Pose X_WE;
  X_WE.p << c * L, -kA3 - q(1), kA1 + s * L;
  X_WE.R << 0.0, -s, c,  //
      1.0, 0.0, 0.0,     //
      0.0, c, s;
  return X_WE;
}

/// The branch L > 0.
inline Vector3 inverseKinematics(const Vector3& p) {
  return {std::atan2(p.z() - kA1, p.x()), -p.y() - kA3, std::hypot(p.x(), p.z() - kA1) - kA2 - kA4};
}

inline Matrix3 positionJacobian(const Vector3& q) {
  const double c = std::cos(q(0)), s = std::sin(q(0)), L = reach(q);
  Matrix3 J_P;
  J_P << -s * L, 0.0, c,  //
      0.0, -1.0, 0.0,     //
      c * L, 0.0, s;
  return J_P;
}

inline Matrix3 massMatrix(const Vector3& q) {
  const double r = kR3 + q(2);
  return Vector3(kIeq + kM3 * r * r, kSlidingMass, kM3).asDiagonal();
}

/// From Christoffel symbols of the first kind; only dB11/dq3 = 2 m3 (r3 + q3) is not zero.
inline Matrix3 coriolisMatrix(const Vector3& q, const Vector3& qd) {
  const double h = kM3 * (kR3 + q(2));
  Matrix3 C = Matrix3::Zero();
  C(0, 0) = h * qd(2);
  C(0, 2) = h * qd(0);
  C(2, 0) = -h * qd(0);
  return C;
}

inline Vector3 gravityEffort(const Vector3& q) {
  return kGravity * Vector3(std::cos(q(0)) * (kS0 + kM3 * (kR3 + q(2))), 0.0, kM3 * std::sin(q(0)));
}

}  // namespace baton::test::rpp
