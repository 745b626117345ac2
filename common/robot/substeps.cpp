#include "robot/substeps.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <limits>

#include "base/elementary.hpp"
#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

/// How far from the origin RK4 is stable in the direction of a pole that does not grow by itself.
double stableDistance(const std::complex<double>& direction) {
  constexpr double kFarthest = 3.0, kNearest = 2.0, kStep = 1e-3, kRounding = 1e-9;
  double distance = kFarthest;
  for (; distance > kNearest; distance -= kStep) {
    const std::complex<double> z = distance * direction;
    const std::complex<double> growth = 1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)));
    if (elementary::hypot(growth.real(), growth.imag()) <= 1.0 + kRounding) break;
  }
  return distance;
}

}  // namespace

JointVector frictionSlope(const RobotModel& model) {
  JointVector slope(model.size());
  for (int i = 0; i < model.size(); ++i) {
    const JointFriction& friction = model.joints[static_cast<std::size_t>(i)].friction;
    slope(i) = friction.viscous + friction.coulomb / friction.coulomb_velocity;
  }
  return slope;
}

double SubstepNeed::substeps(double step_s) const {
  constexpr double kRounding = 1e-9;
  return std::max(1.0, std::ceil(step_s / longest_s * (1.0 - kRounding)));
}

SubstepNeed substepNeed(const RobotModel& model, const JointVector& q, const StiffTerms& terms) {
  const Eigen::Index n = model.size();
  JointMatrix B;
  massMatrix(model, q, B);
  Kinematics kinematics;
  computeKinematics(model, q, JointVector::Zero(n), kinematics);
  const auto J = kinematics.J.topRows<3>();
  const Eigen::MatrixXd stiffness = J.transpose() * terms.tip_stiffness * J;
  Eigen::MatrixXd damping = J.transpose() * terms.tip_damping * J;
  damping.diagonal() += terms.joint_damping;
  // In coordinates in which the mass matrix is 1, and with velocities scaled so that the blocks are of one size.
  const Eigen::LLT<Eigen::MatrixXd> root{Eigen::MatrixXd(B)};
  const auto scaled = [&](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
    const Eigen::MatrixXd half = root.matrixL().solve(matrix);
    return root.matrixL().solve(half.transpose());
  };
  const Eigen::MatrixXd K = scaled(stiffness), D = scaled(damping);
  const double rate = std::sqrt(std::max(K.norm(), std::numeric_limits<double>::min()));
  Eigen::MatrixXd system(2 * n, 2 * n);
  system << Eigen::MatrixXd::Zero(n, n), rate * Eigen::MatrixXd::Identity(n, n), -K / rate, -D;

  SubstepNeed need{.pole_per_s = 0.0, .longest_s = std::numeric_limits<double>::infinity()};
  if (!system.allFinite()) return need;
  const Eigen::VectorXcd poles = Eigen::EigenSolver<Eigen::MatrixXd>(system, false).eigenvalues();
  for (const std::complex<double>& pole : poles) {
    const double magnitude = elementary::hypot(pole.real(), pole.imag());
    if (!(magnitude > 0.0)) continue;
    const double longest_s = stableDistance(pole / magnitude) / magnitude;
    if (longest_s < need.longest_s) need = {magnitude, longest_s};
  }
  return need;
}

}  // namespace baton
