/// Checks of laws that follow a motion: inverse dynamics in joint and task space, and adaptive control.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "robot/regressor.hpp"
#include "theory_tools.hpp"

namespace baton::theory {
namespace {

/// What inverse dynamics makes linear: the joints, or the tip's position.
struct Linear {
  const Eigen::MatrixXd& wanted;
  const Eigen::MatrixXd& actual;
  Eigen::VectorXd kp, kd;
  Eigen::VectorXd e0, ed0;  // at the start
  std::vector<std::string> names, units;
};

Linear linearOf(const Trace& run) {
  expectLaw(run, {"joint_inverse_dynamics", "operational_inverse_dynamics"});
  const RobotModel& robot = run.scenario.robot;
  const Reference wanted = referenceAt(run, 0);
  if (controllerOf(run).law == "joint_inverse_dynamics") {
    Linear linear{run.q_d,
                  run.q,
                  gain<JointVector>(run, "kp"),
                  gain<JointVector>(run, "kd"),
                  wanted.q - run.scenario.start_q,
                  wanted.qd - run.scenario.start_qd,
                  {},
                  {}};
    for (int i = 0; i < robot.size(); ++i) {
      linear.names.push_back(jointName(i));
      linear.units.push_back(jointUnit(robot, i));
    }
    return linear;
  }
  const Eigen::MatrixXd J_P = positionJacobian(robot, run.scenario.start_q);
  const Vector3 x = tipPose(robot, run.scenario.start_q).p;
  const Vector3 xd = J_P * run.scenario.start_qd;
  return {run.p_WE_d,
          run.p_WE,
          gain<Vector6>(run, "kp").head<3>(),
          gain<Vector6>(run, "kd").head<3>(),
          wanted.X_WE.p - x,
          wanted.V_WE.head<3>() - xd,
          {kAxes[0], kAxes[1], kAxes[2]},
          {"m", "m", "m"}};
}

/// Half of what one coordinate of the predicted motion travels in a step at its fastest.
double halfStepTravel(const Trace& run, const Linear& linear, int i) {
  Largest travel;
  double before = linear.wanted(i, 0) - linear.e0(i);
  for (Eigen::Index k = 1; k <= restStep(run); ++k) {
    const FreeResponse e = freeResponse(1.0, linear.kd(i), linear.kp(i), {linear.e0(i), linear.ed0(i)}, run.time(k));
    const double here = linear.wanted(i, k) - e.e;
    travel.add(std::abs(here - before));
    before = here;
  }
  return travel / 2.0;
}

/// The plain continuous closed loop of the adaptive law, any number of joints:
///   tau = Y Th + Kd s,  Th' = Gamma Y^T s,  qd_r = qd_d + lam e,  s = qd_r - qd,  Gamma as the law's head says.
/// The error e at every step, n x steps.
Eigen::MatrixXd adaptiveError(const Trace& run) {
  expectLaw(run, {"adaptive"});
  const std::string& adaptation = option(run, "adaptation");
  // A start with a large error makes qdd_r, Y and with them Y Gamma Y^T large: for a moment, estimate and error swing
  // against each other much faster than anything else.
  const int substeps = adaptation == "off" ? 2 : 8;
  const RobotModel& robot = run.scenario.robot;
  const Trajectory trajectory(robot, run.scenario.trajectory);
  const Eigen::Index n = robot.size();
  const JointVector lambda = gain<JointVector>(run, "lambda"), kd = gain<JointVector>(run, "kd");
  const double k = number(controllerOf(run).parameters, "k");
  const DynamicParameters truth = dynamicParameters(robot);
  Eigen::VectorXd rates = Eigen::VectorXd::Constant(truth.size(), adaptation == "on"        ? 1.0 / k
                                                                  : adaptation == "times_k" ? k
                                                                                            : 0.0);
  for (Eigen::Index i = 0; i < n; ++i) {  // first moments count times gravity
    rates.segment<3>(i * kParametersPerJoint + 1) /= robot.gravity_W.squaredNorm();
  }
  if (option(run, "unknowns") == "nonzero") rates = (truth.array() != 0.0).select(rates, 0.0);

  const auto derivative = [&](double time_s, const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Reference wanted;
    trajectory.evaluate(time_s, wanted);
    const JointVector q = x.head(n), qd = x.segment(n, n);
    const JointVector qd_r = wanted.qd + lambda.cwiseProduct(wanted.q - q);
    const JointVector qdd_r = wanted.qdd + lambda.cwiseProduct(wanted.qd - qd);
    const JointVector s = qd_r - qd;
    Regressor Y;
    dynamicsRegressor(robot, q, qd, qd_r, qdd_r, Y);
    const JointVector tau = Y * x.tail(truth.size()) + kd.cwiseProduct(s);
    JointVector qdd = JointVector::Constant(n, std::nan(""));
    if (!forwardDynamics(robot, q, qd, tau, Vector6::Zero(), qdd)) qdd.setConstant(std::nan(""));
    Eigen::VectorXd xd(x.size());
    xd << qd, qdd, rates.cwiseProduct(Eigen::VectorXd(Y.transpose() * s));
    return xd;
  };
  Eigen::VectorXd start(2 * n + truth.size());
  start << run.scenario.start_q, run.scenario.start_qd, number(controllerOf(run).parameters, "initial_scale") * truth;
  return run.q_d - integrate(run, derivative, start, substeps).topRows(n);
}

/// rms of one joint's error over a part of the run.
double rms(const Eigen::MatrixXd& error, int joint, Eigen::Index from, Eigen::Index to) {
  return std::sqrt(error.row(joint).segment(from, to - from).cwiseAbs2().mean());
}

}  // namespace

// e'' + Kd e' + Kp e = 0 from the error of the start, in closed form. Compared over the whole run, and where it has
// fallen to about a third.
Checks secondOrderError(const Inputs& in) {
  const Trace& run = in.run;
  const Linear linear = linearOf(run);
  Checks checks;
  for (int i = 0; i < linear.kp.size(); ++i) {
    const std::string& name = linear.names[static_cast<std::size_t>(i)];
    const std::string& unit = linear.units[static_cast<std::size_t>(i)];
    const auto closedForm = [&](Eigen::Index k) {
      return freeResponse(1.0, linear.kd(i), linear.kp(i), {linear.e0(i), linear.ed0(i)}, run.time(k)).e;
    };
    const auto measured = [&](Eigen::Index k) { return linear.wanted(i, k) - linear.actual(i, k); };
    const double allowed = halfStepTravel(run, linear, i);
    Largest worst;
    Eigen::Index third = -1;
    for (Eigen::Index k = 0; k <= restStep(run); ++k) {
      worst.add(std::abs(measured(k) - closedForm(k)));
      if (third < 0 && std::abs(closedForm(k)) < std::abs(linear.e0(i)) / 3.0) third = k;
    }
    checks.push_back(
        within("largest difference of the error of " + name + " from its closed form", unit, 0.0, worst, allowed));
    if (std::abs(linear.e0(i)) > 10.0 * allowed && third >= 0) {
      checks.push_back(within("error of " + name + " at " + std::to_string(run.time(third)) + " s", unit,
                              closedForm(third), measured(third), allowed));
    }
  }
  return checks;
}

// Once the error of the start has faded, below 1e-6 by its closed form, none is left while the arm moves on, and none
// at the end. A law on the tip's position takes an arm of three joints along with it, and the orientation with them.
Checks tracks(const Inputs& in) {
  const Trace& run = in.run;
  const Linear linear = linearOf(run);
  const auto isForgotten = [&](int i, Eigen::Index k) {
    return std::abs(freeResponse(1.0, linear.kd(i), linear.kp(i), {linear.e0(i), linear.ed0(i)}, run.time(k)).e) < 1e-6;
  };
  Checks checks;
  for (int i = 0; i < linear.kp.size(); ++i) {
    const std::string& name = linear.names[static_cast<std::size_t>(i)];
    const std::string& unit = linear.units[static_cast<std::size_t>(i)];
    Largest worst;
    for (Eigen::Index k = 0; k <= restStep(run); ++k) {
      if (isForgotten(i, k)) worst.add(std::abs(linear.wanted(i, k) - linear.actual(i, k)));
    }
    checks.push_back(within("largest error of " + name + " once the error of the start has faded", unit, 0.0, worst,
                            halfStepTravel(run, linear, i)));
    checks.push_back(atRest("error of " + name + " at the end", unit, 0.0,
                            linear.wanted(i, restStep(run)) - linear.actual(i, restStep(run))));
  }
  if (controllerOf(run).law != "operational_inverse_dynamics") return checks;
  Largest worst, turn;  // turn: of the tip in half a step at its fastest
  for (Eigen::Index k = 0; k <= restStep(run); ++k) {
    turn.add(referenceAt(run, k).V_WE.tail<3>().norm() * run.scenario.stepSeconds() / 2.0);
    if (isForgotten(0, k) && isForgotten(1, k) && isForgotten(2, k)) worst.add(run.orientation.col(k).norm());
  }
  checks.push_back(within("largest angle from the desired orientation once the error of the start has faded", "rad",
                          0.0, worst, turn));
  checks.push_back(
      atRest("angle from the desired orientation at the end", "rad", 0.0, run.orientation.col(restStep(run)).norm()));
  return checks;
}

// The same law with and without its adaptation, second half of the run: the rms error with it, and what it takes away
// from the one without, as a part.
Checks adaptationEffect(const Inputs& in) {
  constexpr double kTolerance = 2e-2;  // one step's hold against lam, lam dt, and against Kd over the inertia
  const Trace &with = in.run, &without = *in.other;
  const Eigen::MatrixXd predicted_with = adaptiveError(with), predicted_without = adaptiveError(without);
  const Eigen::Index from = with.steps() / 2, to = restStep(with);
  const std::string adaptation = "adaptation " + option(with, "adaptation");
  Checks checks;
  for (int i = 0; i < with.scenario.robot.size(); ++i) {
    const std::string error = "rms error of " + jointName(i);
    const double predicted = rms(predicted_with, i, from, to), measured = rms(with.q_d - with.q, i, from, to);
    checks.push_back(
        relative(error + ", " + adaptation, jointUnit(with.scenario.robot, i), predicted, measured, kTolerance));
    const double taken = 1.0 - predicted / rms(predicted_without, i, from, to);
    checks.push_back(within("part of the " + error + " that " + adaptation + " takes away", "", taken,
                            1.0 - measured / rms(without.q_d - without.q, i, from, to),
                            kTolerance * std::max(0.01, std::abs(taken))));
  }
  return checks;
}

// The rms error over the first and the last quarter of the run, from the continuous closed loop. The first second is
// left out: in it the error of the start fades at the rate lam, learning or not.
Checks adaptationLearns(const Inputs& in) {
  // What is left at the end has faded by up to four time constants, and a step changes each by about a hundredth.
  constexpr double kTolerance = 0.05;
  const Trace& run = in.run;
  const Eigen::MatrixXd predicted = adaptiveError(run), measured = run.q_d - run.q;
  const Eigen::Index quarter = run.steps() / 4, end = restStep(run);
  const auto begin = static_cast<Eigen::Index>(std::llround(1.0 / run.scenario.stepSeconds()));
  if (begin >= quarter) throw UsageError("run " + run.scenario.name + ": expected more than 4 s for this check");
  Checks checks;
  for (int i = 0; i < run.scenario.robot.size(); ++i) {
    const std::string name = jointName(i), unit = jointUnit(run.scenario.robot, i);
    checks.push_back(relative("rms error of " + name + ", first quarter without its first second", unit,
                              rms(predicted, i, begin, quarter), rms(measured, i, begin, quarter), kTolerance));
    checks.push_back(relative("rms error of " + name + ", last quarter", unit, rms(predicted, i, end - quarter, end),
                              rms(measured, i, end - quarter, end), kTolerance));
  }
  return checks;
}

}  // namespace baton::theory
