#include "theory_tools.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/error.hpp"
#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "robot/simulation.hpp"

namespace baton::theory {
namespace {

constexpr double kTurn = 2.0 * 3.14159265358979323846;

/// Of central differences: their error is of the order of its square, rounding of the order of 1e-16 over it.
constexpr double kDifference = 1e-5;

}  // namespace

const ControllerConfig& controllerOf(const Trace& trace) { return trace.scenario.controller(trace.scenario.active); }

void expectLaw(const Trace& trace, const std::vector<std::string>& laws) {
  const std::string& law = controllerOf(trace).law;
  if (std::find(laws.begin(), laws.end(), law) != laws.end()) return;
  std::string known;
  for (const std::string& name : laws) known += (known.empty() ? "" : " or ") + name;
  throw UsageError("run " + trace.scenario.name + ": expected a run under " + known + " for this check, found " + law);
}

const std::string& option(const Trace& trace, const std::string& name) {
  return choice(controllerOf(trace).parameters, name);
}

Eigen::Index restStep(const Trace& trace) { return trace.last() - 1; }

Reference referenceAt(const Trace& trace, Eigen::Index step) {
  Reference reference;
  Trajectory(trace.scenario.robot, trace.scenario.trajectory).evaluate(trace.time(step), reference);
  return reference;
}

Reference goalOf(const Trace& trace) { return referenceAt(trace, restStep(trace)); }

Trajectory quietTrajectory(const Scenario& scenario) {
  TrajectorySpec quiet = scenario.trajectory;
  quiet.noise.reset();
  return {scenario.robot, quiet};
}

Vector3 wallForce(const Scenario& scenario, const Vector3& p) {
  Vector3 force = Vector3::Zero();
  for (const PlaneSpec& wall : scenario.walls) {
    const Vector3 normal = wall.normal.normalized();
    const double depth = normal.dot(p - wall.point_m);
    if (depth > 0.0 || !wall.unilateral) force += wall.stiffness_N_per_m * depth * normal;
  }
  return force;
}

JointVector gravity(const RobotModel& robot, const JointVector& q) {
  JointVector g;
  gravityEffort(robot, q, g);
  return g;
}

JointMatrix inertia(const RobotModel& robot, const JointVector& q) {
  JointMatrix B;
  massMatrix(robot, q, B);
  return B;
}

Eigen::MatrixXd positionJacobian(const RobotModel& robot, const JointVector& q) {
  return slope([&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return tipPose(robot, x).p; }, q);
}

Vector6 zyzTaskError(const Reference& goal, const RobotModel& robot, const JointVector& q) {
  const Pose X_WE = tipPose(robot, q);
  const Vector3 angles = zyzFromRotation(goal.X_WE.R) - zyzFromRotation(X_WE.R);
  Vector6 error;
  error << goal.X_WE.p - X_WE.p, angles.unaryExpr([](double angle) { return std::remainder(angle, kTurn); });
  return error;
}

Eigen::MatrixXd zyzTaskJacobian(const Reference& goal, const RobotModel& robot, const JointVector& q) {
  Eigen::MatrixXd J(6, q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    JointVector plus = q, minus = q;
    plus(i) += kDifference;
    minus(i) -= kDifference;
    const Vector6 moved = zyzTaskError(goal, robot, minus) - zyzTaskError(goal, robot, plus);
    J.col(i) << moved.head<3>(), moved.tail<3>().unaryExpr([](double a) { return std::remainder(a, kTurn); });
  }
  return J / (2.0 * kDifference);
}

Eigen::MatrixXd slope(const Residual& residual, const Eigen::VectorXd& x) {
  Eigen::MatrixXd J;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::VectorXd plus = x, minus = x;
    plus(i) += kDifference;
    minus(i) -= kDifference;
    const Eigen::VectorXd column = (residual(plus) - residual(minus)) / (2.0 * kDifference);
    if (J.size() == 0) J.resize(column.size(), x.size());
    J.col(i) = column;
  }
  return J;
}

Eigen::VectorXd solve(const Residual& residual, const Eigen::VectorXd& start) {
  constexpr int kMaxIterations = 100;
  constexpr double kConverged = 1e-11;
  Eigen::VectorXd x = start;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::VectorXd change = slope(residual, x).partialPivLu().solve(residual(x));
    x -= change;
    if (!x.allFinite()) break;
    if (change.norm() < kConverged) return x;
  }
  return Eigen::VectorXd::Constant(start.size(), std::numeric_limits<double>::quiet_NaN());
}

Eigen::MatrixXd integrate(const Trace& trace, const Derivative& derivative, const Eigen::VectorXd& start,
                          int substeps) {
  const double dt_s = trace.scenario.stepSeconds();
  const double h = dt_s / substeps;
  Eigen::MatrixXd states(start.size(), trace.steps());
  Eigen::VectorXd x = start;
  states.col(0) = x;
  for (Eigen::Index k = 1; k < trace.steps(); ++k) {
    for (int i = 0; i < substeps; ++i) {
      const double t = trace.time(k - 1) + i * h;
      const Eigen::VectorXd k1 = derivative(t, x);
      const Eigen::VectorXd k2 = derivative(t + h / 2.0, x + h / 2.0 * k1);
      const Eigen::VectorXd k3 = derivative(t + h / 2.0, x + h / 2.0 * k2);
      const Eigen::VectorXd k4 = derivative(t + h, x + h * k3);
      x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    states.col(k) = x;
  }
  return states;
}

Eigen::MatrixXd motionUnder(const Trace& run, const Effort& effort) {
  constexpr int kSubsteps = 2;
  const RobotModel& robot = run.scenario.robot;
  const Trajectory trajectory(robot, run.scenario.trajectory);
  const Eigen::Index n = robot.size();
  const auto derivative = [&](double time_s, const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Reference reference;
    trajectory.evaluate(time_s, reference);
    const JointVector q = x.head(n), qd = x.tail(n);
    JointVector tau = effort(reference, q, qd), qdd = JointVector::Constant(n, std::nan(""));
    saturateEffort(robot, tau);
    Vector6 h_e = Vector6::Zero();
    if (run.scenario.hasEnvironment()) h_e.head<3>() = wallForce(run.scenario, tipPose(robot, q).p);
    if (!forwardDynamics(robot, q, qd, tau, h_e, qdd)) qdd.setConstant(std::nan(""));
    Eigen::VectorXd xd(2 * n);
    xd << qd, qdd;
    return xd;
  };
  Eigen::VectorXd start(2 * n);
  start << run.scenario.start_q, run.scenario.start_qd;
  return integrate(run, derivative, start, kSubsteps);
}

FreeResponse freeResponse(double m, double d, double k, const FreeResponse& start, double time_s) {
  // e = a exp(s1 t) + b exp(s2 t), s1 and s2 real or conjugate; two equal ones, which no scenario here has, are moved
  // apart by a hair.
  using Complex = std::complex<double>;
  const Complex root = std::sqrt(Complex(d * d - 4.0 * m * k, 1e-12 * d * d));
  const Complex s1 = (-d + root) / (2.0 * m), s2 = (-d - root) / (2.0 * m);
  const Complex b = (start.ed - s1 * start.e) / (s2 - s1), a = start.e - b;
  const Complex e1 = a * std::exp(s1 * time_s), e2 = b * std::exp(s2 * time_s);
  return {(e1 + e2).real(), (s1 * e1 + s2 * e2).real()};
}

Check atRest(std::string what, std::string unit, double predicted, double measured) {
  constexpr double kZero = 1e-9;  // the rounding of a prediction
  if (std::abs(predicted) < kZero) return within(std::move(what), std::move(unit), predicted, measured, 1e-6);
  return relative(std::move(what), std::move(unit), predicted, measured, 1e-4);
}

Check within(std::string what, std::string unit, double predicted, double measured, double tolerance) {
  return {std::move(what), std::move(unit), predicted, measured, tolerance, false};
}

Check relative(std::string what, std::string unit, double predicted, double measured, double tolerance) {
  return {std::move(what), std::move(unit), predicted, measured, tolerance, true};
}

std::vector<Check> wallForcesAtRest(const Trace& trace, const Vector3& p) {
  const Vector3 predicted = wallForce(trace.scenario, p), measured = trace.h_e.col(restStep(trace)).head<3>();
  std::vector<Check> checks;
  for (const PlaneSpec& wall : trace.scenario.walls) {
    const Vector3 normal = wall.normal.normalized();
    checks.push_back(atRest("force on the wall", "N", normal.dot(predicted), normal.dot(measured)));
  }
  return checks;
}

std::string jointName(int i) { return "q" + std::to_string(i + 1); }

std::string jointUnit(const RobotModel& robot, int i) {
  return robot.joints[static_cast<std::size_t>(i)].kind == JointKind::kRevolute ? "rad" : "m";
}

std::string effortUnit(const RobotModel& robot, int i) {
  return robot.joints[static_cast<std::size_t>(i)].kind == JointKind::kRevolute ? "N m" : "N";
}

}  // namespace baton::theory
