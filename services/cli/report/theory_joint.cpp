/// Checks of joint-space laws at set-points and after a motion: joint PD, and inverse dynamics with parts of its model
/// wrong or left out. e = q_d - q; n = C qd + g.
#include <cmath>

#include "robot/dynamics.hpp"
#include "robot/simulation.hpp"
#include "theory_tools.hpp"

namespace baton::theory {
namespace {

JointVector at(const Eigen::MatrixXd& matrix, Eigen::Index step) { return matrix.col(step); }

/// Errors at rest, joint by joint, where `residual` of q is zero.
Checks offsetsAtRest(const Trace& run, const Residual& residual) {
  const JointVector q_d = goalOf(run).q;
  const JointVector predicted = q_d - JointVector(solve(residual, q_d));
  const JointVector measured = q_d - at(run.q, restStep(run));
  Checks checks;
  for (int i = 0; i < q_d.size(); ++i) {
    checks.push_back(
        atRest("error of " + jointName(i) + " at rest", jointUnit(run.scenario.robot, i), predicted(i), measured(i)));
  }
  return checks;
}

}  // namespace

// Whatever cancels gravity leaves e = 0.
Checks reachesGoal(const Inputs& in) {
  const JointVector error = goalOf(in.run).q - at(in.run.q, restStep(in.run));
  Checks checks;
  for (int i = 0; i < error.size(); ++i) {
    checks.push_back(
        atRest("error of " + jointName(i) + " at the end", jointUnit(in.run.scenario.robot, i), 0.0, error(i)));
  }
  return checks;
}

// B e'' + Kd e' + Kp e = 0 near the goal: the error fades at the slower root, measured over the second quarter of the
// run. Acting once a step moves a root s by a part of about |s| dt, and B Kp / Kd^2 of that here: below 1e-4.
Checks decayRate(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"joint_pd"});
  const JointVector q_d = goalOf(run).q, kp = gain<JointVector>(run, "kp"), kd = gain<JointVector>(run, "kd");
  const JointMatrix B = inertia(run.scenario.robot, q_d);
  const Eigen::Index from = run.last() / 4, to = run.last() / 2;
  Checks checks;
  for (int i = 0; i < q_d.size(); ++i) {
    const double slow = (kd(i) - std::sqrt(kd(i) * kd(i) - 4.0 * B(i, i) * kp(i))) / (2.0 * B(i, i));
    const double faded = std::log(std::abs((q_d(i) - run.q(i, from)) / (q_d(i) - run.q(i, to))));
    checks.push_back(relative("rate at which the error of " + jointName(i) + " fades", "1/s", slow,
                              faded / (run.time(to) - run.time(from)), 1e-4));
  }
  return checks;
}

// Kp e = g(q) - g_c, g_c what is compensated: nothing, or gravity at one position.
Checks gravityOffset(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"joint_pd"});
  const RobotModel& robot = run.scenario.robot;
  const JointVector q_d = goalOf(run).q, kp = gain<JointVector>(run, "kp");
  const bool is_fixed = option(run, "gravity") == "fixed", is_full = option(run, "gravity") == "full";
  const JointVector fixed = is_fixed ? gravity(robot, gain<JointVector>(run, "gravity_position"))
                                     : JointVector(JointVector::Zero(robot.size()));
  return offsetsAtRest(run, [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
    const JointVector compensated = is_full ? gravity(robot, q) : fixed;
    return kp.cwiseProduct(q_d - q) + compensated - gravity(robot, q);
  });
}

namespace {

/// rms of q - q_d from 10 s on, q_d without its noise; predicted (first) and measured. Within a step the noisy
/// set-point is constant, so that the error to it moves freely: m e'' + Kd e' + Kp e = 0, m the inertia at q_d for a
/// PD, 1 for inverse dynamics. Exact for the joints by themselves; their coupling is of second order in the noise.
struct NoiseRms {
  JointVector predicted, measured;
};

NoiseRms noiseRms(const Trace& run) {
  constexpr double kFrom_s = 10.0;
  expectLaw(run, {"joint_pd", "joint_inverse_dynamics"});
  const Scenario& scenario = run.scenario;
  const int n = scenario.robot.size();
  const Trajectory noisy(scenario.robot, scenario.trajectory), smooth = quietTrajectory(scenario);
  Reference goal, wanted;
  smooth.evaluate(run.time(run.last()), goal);
  const JointVector kp = gain<JointVector>(run, "kp"), kd = gain<JointVector>(run, "kd");
  const JointVector m = controllerOf(run).law == "joint_pd" ? JointVector(inertia(scenario.robot, goal.q).diagonal())
                                                            : JointVector(JointVector::Ones(n));

  JointVector q = scenario.start_q, qd = scenario.start_qd;
  JointVector predicted = JointVector::Zero(n), measured = JointVector::Zero(n);
  int count = 0;
  for (Eigen::Index k = 0; k <= restStep(run); ++k) {
    if (run.time(k) >= kFrom_s) {
      predicted += (q - goal.q).cwiseAbs2();
      measured += (at(run.q, k) - goal.q).cwiseAbs2();
      ++count;
    }
    noisy.evaluate(run.time(k), wanted);
    for (int i = 0; i < n; ++i) {
      const FreeResponse next = freeResponse(m(i), kd(i), kp(i), {wanted.q(i) - q(i), -qd(i)}, scenario.stepSeconds());
      q(i) = wanted.q(i) - next.e;
      qd(i) = -next.ed;
    }
  }
  return {(predicted / count).cwiseSqrt(), (measured / count).cwiseSqrt()};
}

}  // namespace

Checks noiseResponse(const Inputs& in) {
  // A step against the slow pole of a few 1/s, and the coupling of the joints: both about a thousandth.
  constexpr double kTolerance = 2e-3;
  const NoiseRms one = noiseRms(in.run), two = noiseRms(*in.other);
  const RobotModel& robot = in.run.scenario.robot;
  Checks checks;
  for (int i = 0; i < robot.size(); ++i) {
    const std::string name = jointName(i), unit = jointUnit(robot, i);
    const auto rms = [&](const Trace& run) { return "rms of " + name + " about its goal, " + controllerOf(run).law; };
    checks.push_back(relative(rms(in.run), unit, one.predicted(i), one.measured(i), kTolerance));
    checks.push_back(relative(rms(*in.other), unit, two.predicted(i), two.measured(i), kTolerance));
    checks.push_back(relative("noise in " + name + ", second law over first", "", two.predicted(i) / one.predicted(i),
                              two.measured(i) / one.measured(i), kTolerance));
  }
  return checks;
}

// s (B Kp e + g) = g with masses s times as large: Kp e = (1/s - 1) B^-1 g(q).
Checks massScaleOffset(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"joint_inverse_dynamics"});
  const RobotModel& robot = run.scenario.robot;
  const JointVector q_d = goalOf(run).q, kp = gain<JointVector>(run, "kp");
  const double s = number(controllerOf(run).parameters, "mass_scale");
  return offsetsAtRest(run, [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
    return inertia(robot, q) * kp.cwiseProduct(q_d - q) - (1.0 / s - 1.0) * gravity(robot, q);
  });
}

// tau = y + n: B qdd = qdd_d + Kd e' + Kp e. Nothing is left at rest; on the way the error is the solution of that.
Checks settlesAfterMotion(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"joint_inverse_dynamics"});
  const RobotModel& robot = run.scenario.robot;
  const JointVector kp = gain<JointVector>(run, "kp"), kd = gain<JointVector>(run, "kd");
  const Eigen::MatrixXd motion =
      motionUnder(run, [&](const Reference& ref, const JointVector& q, const JointVector& qd) {
        JointVector n;
        biasEffort(robot, q, qd, n);
        return JointVector(ref.qdd + kd.cwiseProduct(ref.qd - qd) + kp.cwiseProduct(ref.q - q) + n);
      });
  Checks checks = reachesGoal(in);
  for (int i = 0; i < robot.size(); ++i) {
    Largest predicted, measured, speed;
    for (Eigen::Index k = 0; k <= restStep(run); ++k) {
      const double wanted = run.q_d(i, k);
      predicted.add(std::abs(wanted - motion(i, k)));
      measured.add(std::abs(wanted - run.q(i, k)));
      speed.add(std::abs(motion(robot.size() + i, k)));
    }
    checks.push_back(within("largest error of " + jointName(i) + " on the way", jointUnit(robot, i), predicted,
                            measured, speed * run.scenario.stepSeconds() / 2.0));
  }
  return checks;
}

// tau = B y: B Kp e = g(q).
Checks biasOffset(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"joint_inverse_dynamics"});
  const RobotModel& robot = run.scenario.robot;
  const JointVector q_d = goalOf(run).q, kp = gain<JointVector>(run, "kp");
  return offsetsAtRest(run, [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
    return inertia(robot, q) * kp.cwiseProduct(q_d - q) - gravity(robot, q);
  });
}

// tau = y: Kp e = g(q). Beside it the error of the other run, which still has its B: joint by joint about B_ii as
// large, since there B_ii Kp e = g.
Checks uncompensatedOffset(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"joint_inverse_dynamics"});
  const RobotModel& robot = run.scenario.robot;
  const JointVector q_d = goalOf(run).q, kp = gain<JointVector>(run, "kp");
  Checks checks = offsetsAtRest(
      run, [&](const Eigen::VectorXd& q) -> Eigen::VectorXd { return kp.cwiseProduct(q_d - q) - gravity(robot, q); });
  const Checks with_inertia = biasOffset({.run = *in.other});
  for (std::size_t i = 0; i < with_inertia.size(); ++i) {
    const Check &one = checks[i], &two = with_inertia[i];
    if (!one.is_relative || !two.is_relative) continue;  // no error to compare
    checks.push_back(relative(one.what + ", as a part of the run with B", "", one.predicted / two.predicted,
                              one.measured / two.measured, 2e-4));
  }
  return checks;
}

// tau(0) = B (qdd_d + Kd e' + Kp e) + n at the start, cut at the limits; from there the torque only falls.
Checks firstTorque(const Inputs& in) {
  constexpr double kSameState = 1e-9;  // nothing has moved yet, so the two differ by rounding
  const Trace& run = in.run;
  expectLaw(run, {"joint_inverse_dynamics"});
  const RobotModel& robot = run.scenario.robot;
  const JointVector &q = run.scenario.start_q, &qd = run.scenario.start_qd;
  const Reference wanted = referenceAt(run, 0);
  const JointVector y = wanted.qdd + gain<JointVector>(run, "kd").cwiseProduct(wanted.qd - qd) +
                        gain<JointVector>(run, "kp").cwiseProduct(wanted.q - q);
  JointVector n;
  biasEffort(robot, q, qd, n);
  JointVector tau = inertia(robot, q) * y + n;
  saturateEffort(robot, tau);
  Checks checks;
  for (int i = 0; i < robot.size(); ++i) {
    const std::string name = "tau" + std::to_string(i + 1), unit = effortUnit(robot, i);
    checks.push_back(relative("first effort " + name, unit, tau(i), run.tau(i, 1), kSameState));
    const double peak = run.tau.row(i).tail(run.last()).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    checks.push_back(relative("largest effort |" + name + "|", unit, std::abs(tau(i)), peak, kSameState));
  }
  return checks;
}

namespace {

/// From when on each joint stays within 2 % of its way from start to goal [s], of positions step by step, n x steps.
JointVector settlingTimes(const Trace& run, const Eigen::MatrixXd& q) {
  constexpr double kSettled = 0.02;
  const JointVector goal = goalOf(run).q;
  JointVector times = JointVector::Zero(goal.size());
  for (Eigen::Index k = 0; k <= restStep(run); ++k) {
    for (int i = 0; i < goal.size(); ++i) {
      const double way = std::abs(goal(i) - run.scenario.start_q(i));
      if (!(std::abs(goal(i) - q(i, k)) <= kSettled * way)) times(i) = run.time(k + 1);
    }
  }
  return times;
}

/// How far each joint goes beyond its goal, seen from its start.
JointVector overshoot(const Trace& run, const Eigen::MatrixXd& q) {
  const JointVector goal = goalOf(run).q;
  JointVector beyond = JointVector::Zero(goal.size());
  for (int i = 0; i < goal.size(); ++i) {
    const double direction = goal(i) < run.scenario.start_q(i) ? -1.0 : 1.0;
    Largest largest;
    for (Eigen::Index k = 0; k <= restStep(run); ++k) largest.add(direction * (q(i, k) - goal(i)));
    beyond(i) = largest;
  }
  return beyond;
}

}  // namespace

// The same arm and law, with the efforts cut if there are limits, in continuous time: the arm settles in such a time,
// after so much of it at the limit, and nothing is left.
Checks settling(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"joint_inverse_dynamics"});
  const RobotModel& robot = run.scenario.robot;
  const int n = robot.size();
  const JointVector kp = gain<JointVector>(run, "kp"), kd = gain<JointVector>(run, "kd");
  const auto effort = [&](const Reference& ref, const JointVector& q, const JointVector& qd) {
    JointVector bias;
    biasEffort(robot, q, qd, bias);
    const JointVector y = ref.qdd + kd.cwiseProduct(ref.qd - qd) + kp.cwiseProduct(ref.q - q);
    return JointVector(inertia(robot, q) * y + bias);
  };
  const Eigen::MatrixXd motion = motionUnder(run, effort);
  JointVector predicted = JointVector::Zero(n), measured = predicted;
  const double dt_s = run.scenario.stepSeconds();
  for (Eigen::Index k = 0; k <= restStep(run); ++k) {
    const JointVector tau = effort(referenceAt(run, k), motion.col(k).head(n), motion.col(k).tail(n));
    for (int i = 0; i < n; ++i) {
      const double limit = robot.joints[static_cast<std::size_t>(i)].effort_limit;
      predicted(i) += std::abs(tau(i)) >= limit ? dt_s : 0.0;
      measured(i) += std::abs(run.tau(i, k + 1)) >= limit ? dt_s : 0.0;
    }
  }
  const JointVector settled = settlingTimes(run, motion), measured_settled = settlingTimes(run, run.q);
  const JointVector beyond = overshoot(run, motion), measured_beyond = overshoot(run, run.q);
  const JointVector fastest = motion.bottomRows(n).cwiseAbs().rowwise().maxCoeff();
  Checks checks = reachesGoal(in);
  for (int i = 0; i < n; ++i) {
    // Each time that the limit is reached or left may fall a step earlier or later, and it is felt a step late.
    const double allowed = 8.0 * dt_s;
    const std::string name = jointName(i);
    checks.push_back(within("time in which " + name + " settles", "s", settled(i), measured_settled(i), allowed));
    checks.push_back(within("overshoot of " + name, jointUnit(robot, i), beyond(i), measured_beyond(i),
                            beyond(i) > 0.0 ? fastest(i) * allowed : 1e-6));
    if (std::isfinite(robot.joints[static_cast<std::size_t>(i)].effort_limit))
      checks.push_back(within("time of " + name + " at its limit", "s", predicted(i), measured(i), allowed));
  }
  return checks;
}

}  // namespace baton::theory
