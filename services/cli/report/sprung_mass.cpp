#include "sprung_mass.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "theory_tools.hpp"

namespace baton::theory {
namespace {

[[noreturn]] void refuse(const Scenario& scenario, const std::string& expected) {
  throw UsageError("run " + scenario.name + ": expected " + expected + " for this study, found another");
}

}  // namespace

SprungMass sprungMassOf(const Scenario& scenario) {
  const ControllerConfig& controller = scenario.controller(scenario.active);
  if (controller.law != "joint_pd") refuse(scenario, "a run under joint_pd");
  if (scenario.walls.size() != 1 || scenario.walls[0].unilateral) refuse(scenario, "one wall that holds both ways");
  const JointVector along = alongNormal(scenario);
  constexpr double kNothing = 1e-9;  // what the numeric Jacobian leaves of a zero
  if ((along.array().abs() > kNothing).count() != 1) refuse(scenario, "a wall that pushes one joint alone");
  Eigen::Index joint = 0;
  const double lever = along.cwiseAbs().maxCoeff(&joint);
  if (vector<JointVector>(controller.parameters, "kp")(joint) != 0.0) refuse(scenario, "a law without stiffness there");
  const double mobility = along.dot(JointVector(inertia(scenario.robot, scenario.start_q).llt().solve(along)));
  return {.m = 1.0 / mobility,
          .K = scenario.walls.front().stiffness_N_per_m,
          .D = vector<JointVector>(controller.parameters, "kd")(joint) / (lever * lever)};
}

JointVector alongNormal(const Scenario& scenario) {
  return positionJacobian(scenario.robot, scenario.start_q).transpose() * scenario.walls.front().normal.normalized();
}

double depthOf(const Scenario& scenario, const Vector3& p_WE) {
  const PlaneSpec& wall = scenario.walls.front();
  return wall.normal.normalized().dot(p_WE - wall.point_m);
}

Matrix3 stepMap(const SprungMass& mass, Coupling coupling, double dt_s, int substeps) {
  const double omega_2 = mass.K / mass.m;
  const bool follows = coupling == Coupling::kDerivatives;
  // Within the step (x, v)' = (v, -omega^2 x + a) or (v, a), with an acceleration a that does not change. RK4 of a
  // linear system is the series of its exponential up to the fourth power.
  Matrix3 M = Matrix3::Zero();
  M(0, 1) = M(1, 2) = 1.0;
  if (follows) M(1, 0) = -omega_2;
  M *= dt_s / substeps;
  const Matrix3 I = Matrix3::Identity();
  const Matrix3 sub_step = I + M * (I + M / 2.0 * (I + M / 3.0 * (I + M / 4.0)));
  Matrix3 step = I;
  for (int i = 0; i < substeps; ++i) step = sub_step * step;

  Eigen::RowVector3d a(0.0, -mass.D / mass.m, 0.0);
  if (coupling == Coupling::kHeld) a(0) = -omega_2;
  if (coupling == Coupling::kLate) a(2) = -omega_2;
  Matrix3 map = Matrix3::Zero();
  for (Eigen::Index row = 0; row < 2; ++row) {
    map.row(row) = step(row, 2) * a;
    map.row(row).head<2>() += step.row(row).head<2>();
  }
  map(2, 0) = 1.0;
  return map;
}

double spectralRadius(const Matrix3& map) { return map.eigenvalues().cwiseAbs().maxCoeff(); }

double couplingDamping(const SprungMass& mass, Coupling coupling, double dt_s) {
  switch (coupling) {
    case Coupling::kDerivatives: return 0.0;
    case Coupling::kHeld: return -0.5 * mass.K * dt_s;
    case Coupling::kLate: return -1.5 * mass.K * dt_s;
  }
  return 0.0;
}

double stableStep(const SprungMass& mass, Coupling coupling) {
  const double overshoot = 2.0 * mass.m / mass.D, omega = std::sqrt(mass.K / mass.m);
  switch (coupling) {
    case Coupling::kDerivatives: return 2.0 / omega * std::atan(mass.m * omega / mass.D);
    case Coupling::kHeld: return std::min(2.0 * mass.D / mass.K, overshoot);
    case Coupling::kLate: break;
  }
  // b - z (6 + z) / (2 (2 + z)) is positive for short steps and has one root.
  double low = 0.0, high = overshoot;
  const auto dies_out = [&](double dt) {
    const double b = mass.D * dt / mass.m, z = omega * omega * dt * dt;
    return b > z * (6.0 + z) / (2.0 * (2.0 + z));
  };
  if (dies_out(high)) return high;
  constexpr int kHalvings = 60;  // beyond the precision of a double
  for (int i = 0; i < kHalvings; ++i) (dies_out((low + high) / 2.0) ? low : high) = (low + high) / 2.0;
  return low;
}

double measuredGrowth(const Eigen::VectorXd& x, double dt_s) {
  constexpr Eigen::Index kSettled = 20;
  const auto area = [&](Eigen::Index k) { return std::abs(x(k) * x(k + 2) - x(k + 1) * x(k + 1)); };
  const Eigen::Index last = x.size() - 3;
  if (last <= kSettled) return std::nan("");
  return std::log(area(last) / area(kSettled)) / (2.0 * static_cast<double>(last - kSettled) * dt_s);
}

}  // namespace baton::theory
