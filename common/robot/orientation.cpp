/// ZYZ angles, their rates, and the rotation vector: the part of kinematics.hpp that is about orientation alone.
#include <Eigen/Geometry>
#include <cmath>

#include "base/elementary.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSingularSine = 1e-9;  // sin(theta) below this is zero but for rounding

/// atan2 on (-pi, pi], with the cut a hair beyond -pi: an arm that rests on phi = pi must not flip to -pi and back with
/// the rounding of each step.
double angleOf(double y, double x) {
  constexpr double kHair = 1e-9;
  const double angle = elementary::atan2(y, x);
  return angle < -kPi + kHair ? angle + 2.0 * kPi : angle;
}

double sineOfTheta(const Matrix3& R) { return elementary::hypot(R(0, 2), R(1, 2)); }

/// J_A with T^-1 written out; inverse_sine stands for 1 / sin(theta) in the rates of psi and phi.
Jacobian zyzJacobian(const Kinematics& kinematics, double s_theta, double inverse_sine) {
  const Matrix3& R = kinematics.X_WE.R;
  const bool has_phi = s_theta >= kSingularSine;
  const double c_phi = has_phi ? R(0, 2) / s_theta : 1.0, s_phi = has_phi ? R(1, 2) / s_theta : 0.0;
  const double c_theta = R(2, 2);

  Jacobian J_A(6, kinematics.J.cols());
  for (Eigen::Index i = 0; i < kinematics.J.cols(); ++i) {
    const Vector3 omega = kinematics.J.col(i).tail<3>();
    const double theta_rate = c_phi * omega.y() - s_phi * omega.x();
    const double psi_rate = (c_phi * omega.x() + s_phi * omega.y()) * inverse_sine;
    J_A.col(i) << kinematics.J.col(i).head<3>(), omega.z() - c_theta * psi_rate, theta_rate, psi_rate;
  }
  return J_A;
}

}  // namespace

Vector3 zyzFromRotation(const Matrix3& R) noexcept {
  const double sine = sineOfTheta(R);
  const double theta = elementary::atan2(sine, R(2, 2));
  if (sine < kSingularSine) return {0.0, theta, angleOf(R(1, 0), R(1, 1))};
  return {angleOf(R(1, 2), R(0, 2)), theta, angleOf(R(2, 1), -R(2, 0))};
}

Matrix3 zyzRateMatrix(const Vector3& zyz) noexcept {
  const auto [s_phi, c_phi] = elementary::sincos(zyz(0));
  const auto [s_theta, c_theta] = elementary::sincos(zyz(1));
  Matrix3 T;
  T << 0.0, -s_phi, c_phi * s_theta,  //
      0.0, c_phi, s_phi * s_theta,    //
      1.0, 0.0, c_theta;
  return T;
}

bool analyticalJacobian(const Kinematics& kinematics, Jacobian& J_A) noexcept {
  const double s_theta = sineOfTheta(kinematics.X_WE.R);
  if (!(s_theta >= kSingularSine)) return false;  // not "<": NaN is refused too
  J_A = zyzJacobian(kinematics, s_theta, 1.0 / s_theta);
  return true;
}

Jacobian dampedAnalyticalJacobian(const Kinematics& kinematics) noexcept {
  constexpr double kDampedSine = 0.1, kDamping = 0.05;
  const double s_theta = sineOfTheta(kinematics.X_WE.R);
  if (s_theta >= kDampedSine) return zyzJacobian(kinematics, s_theta, 1.0 / s_theta);
  const double nearness = 1.0 - (s_theta / kDampedSine) * (s_theta / kDampedSine);
  return zyzJacobian(kinematics, s_theta, s_theta / (s_theta * s_theta + kDamping * kDamping * nearness));
}

Matrix3 rotationAbout(const Vector3& axis, double angle_rad) noexcept {
  const auto [sine, cosine] = elementary::sincos(angle_rad);
  const Vector3 sine_axis = sine * axis;
  Matrix3 R = ((1.0 - cosine) * axis) * axis.transpose();
  R.diagonal().array() += cosine;
  R(0, 1) -= sine_axis.z();
  R(0, 2) += sine_axis.y();
  R(1, 0) += sine_axis.z();
  R(1, 2) -= sine_axis.x();
  R(2, 0) -= sine_axis.y();
  R(2, 1) += sine_axis.x();
  return R;
}

Vector3 rotationVector(const Matrix3& R) noexcept {
  // By the unit quaternion, which keeps its digits both near 0 and near pi, where the trace and the antisymmetric part
  // of R each lose theirs.
  const Eigen::Quaterniond rotation(R);
  const double w = std::abs(rotation.w());
  const Vector3 axis_sine = std::copysign(1.0, rotation.w()) * rotation.vec();  // axis x sin(angle / 2), angle <= pi
  const double sine = axis_sine.norm();
  if (sine == 0.0) return Vector3::Zero();
  return (2.0 * elementary::atan2(sine, w) / sine) * axis_sine;
}

}  // namespace baton
