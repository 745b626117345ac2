/// Checks of laws on the tip's pose: operational PD and compliance. x~ = x_d - x with ZYZ angles; J_A and J_P by
/// differences of x.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "robot/kinematics.hpp"
#include "theory_tools.hpp"

namespace baton::theory {
namespace {

constexpr double kPi = 3.14159265358979323846;

double angleBetween(double from, double to) { return std::remainder(to - from, 2.0 * kPi); }

/// J_A^T Kp x~ + g_c - g - J_P^T h_e: the effort left over at rest, zero where the arm stays. g_c is what is
/// compensated: gravity, nothing, or gravity at one position.
Residual effortAtRest(const Trace& run) {
  const RobotModel& robot = run.scenario.robot;
  const Reference goal = goalOf(run);
  const Vector6 kp = gain<Vector6>(run, "kp");
  const bool is_full = option(run, "gravity") == "full", is_fixed = option(run, "gravity") == "fixed";
  const JointVector fixed = is_fixed ? gravity(robot, gain<JointVector>(run, "gravity_position"))
                                     : JointVector(JointVector::Zero(robot.size()));
  return [=, &run](const Eigen::VectorXd& q) -> Eigen::VectorXd {
    const RobotModel& arm = run.scenario.robot;
    const JointVector g = gravity(arm, q);
    const Vector3 h_e = wallForce(run.scenario, tipPose(arm, q).p);
    Eigen::VectorXd effort = zyzTaskJacobian(goal, arm, q).transpose() * kp.cwiseProduct(zyzTaskError(goal, arm, q));
    effort -= positionJacobian(arm, q).transpose() * h_e;
    effort += (is_full ? g : fixed) - g;
    return effort;
  };
}

Vector6 measuredError(const Trace& run) {
  const Eigen::Index k = restStep(run);
  Vector6 error;
  error << run.p_WE_d.col(k) - run.p_WE.col(k), 0.0, 0.0, 0.0;
  for (int i = 0; i < 3; ++i) error(3 + i) = angleBetween(run.zyz(i, k), run.zyz_d(i, k));
  return error;
}

/// Where the arm can rest other than at the goal: solutions of effortAtRest() around which it pushes back, looked for
/// from a grid of starts.
std::vector<JointVector> spuriousRests(const Trace& run) {
  constexpr int kPerJoint = 9;
  constexpr double kSame = 1e-6, kReach_m = 1.6;
  const RobotModel& robot = run.scenario.robot;
  const Reference goal = goalOf(run);
  const Residual effort = effortAtRest(run);
  const int n = robot.size();
  std::vector<JointVector> found;
  for (int code = 0; code < static_cast<int>(std::pow(kPerJoint, n)); ++code) {
    JointVector start = run.scenario.start_q;
    for (int i = 0, rest = code; i < n; ++i, rest /= kPerJoint) {
      const double range = robot.joints[static_cast<std::size_t>(i)].kind == JointKind::kRevolute ? kPi : kReach_m;
      start(i) += range * (2.0 * (rest % kPerJoint) / (kPerJoint - 1) - 1.0);
    }
    const JointVector q = solve(effort, start);
    if (!q.allFinite() || zyzTaskError(goal, robot, q).norm() < kSame) continue;
    const Eigen::MatrixXd stiffness = -slope(effort, q);
    const Eigen::MatrixXd symmetric = (stiffness + stiffness.transpose()) / 2.0;
    if (!(symmetric.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() > 0.0)) continue;
    const auto is_same = [&](const JointVector& other) {
      JointVector difference = other - q;
      for (int i = 0; i < n; ++i) {
        if (robot.joints[static_cast<std::size_t>(i)].kind == JointKind::kRevolute)
          difference(i) = std::remainder(difference(i), 2.0 * kPi);
      }
      return difference.norm() < kSame;
    };
    if (std::none_of(found.begin(), found.end(), is_same)) found.push_back(q);
  }
  return found;
}

}  // namespace

// x = x_d, position and orientation.
Checks taskGoal(const Inputs& in) {
  const Trace& run = in.run;
  const Eigen::Index k = restStep(run);
  Checks checks;
  for (int i = 0; i < 3; ++i) {
    checks.push_back(
        atRest(std::string("error of ") + kAxes[i] + " at the end", "m", 0.0, run.p_WE_d(i, k) - run.p_WE(i, k)));
  }
  checks.push_back(atRest("angle from the desired orientation at the end", "rad", 0.0, run.orientation.col(k).norm()));
  return checks;
}

// The walls are where the tip does not come: no force at any step.
Checks noContact(const Inputs& in) {
  const Trace& run = in.run;
  if (!run.scenario.hasEnvironment() || !wallForce(run.scenario, goalOf(run).X_WE.p).isZero(0.0)) {
    throw UsageError("run " + run.scenario.name + ": expected a wall beyond the goal for this check, found none");
  }
  Largest force;
  for (Eigen::Index k = 0; k <= restStep(run); ++k) force.add(run.h_e.col(k).norm());
  return {within("largest force on the way", "N", 0.0, force, 0.0)};
}

// phi and psi jump by pi where q1 passes pi/2, and only there: as often as the scenario's motion takes it there, from
// the start to the first set-point and on. Holds for arms like the report's, whose first joint alone turns the tip.
Checks angleJump(const Inputs& in) {
  const Trace& run = in.run;
  int jumps = 0, crossings = 0;
  double before = std::cos(run.scenario.start_q(0));
  for (Eigen::Index k = 0; k <= restStep(run); ++k) {
    const double here = std::cos(referenceAt(run, k).q(0));
    if (before * here < 0.0) ++crossings;
    before = here;
  }
  Eigen::Index at = -1;  // the step before the first jump
  for (Eigen::Index k = 0; k < restStep(run); ++k) {
    if (std::abs(angleBetween(run.zyz(0, k), run.zyz(0, k + 1))) < kPi / 2.0) continue;
    ++jumps;
    if (at < 0) at = k;
  }
  Checks checks{within("jumps of phi, one for each time that q1 passes pi/2", "", crossings, jumps, 0.0)};
  if (at < 0) {
    checks.push_back(within("a jump of phi to look at", "", 1.0, 0.0, 0.0));
    return checks;
  }
  const auto turn = [&](int angle) { return std::abs(angleBetween(run.zyz(angle, at), run.zyz(angle, at + 1))); };
  const double moved = std::abs(run.q(0, at + 1) - run.q(0, at));
  checks.push_back(within("jump of phi", "rad", kPi, turn(0), 1e-6));
  checks.push_back(within("jump of psi", "rad", kPi, turn(2), 1e-6));
  checks.push_back(within("change of theta meanwhile", "rad", 0.0, turn(1), moved));
  checks.push_back(within("q1 at the jump", "rad", kPi / 2.0, run.q(0, at), moved));
  return checks;
}

// J_A^T Kp x~ = 0 with x~ away from zero. All such places are found from the equation; the run must be at one.
Checks spuriousEquilibrium(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"operational_pd", "compliance"});
  const RobotModel& robot = run.scenario.robot;
  const Eigen::Index k = restStep(run);
  const JointVector rest = run.q.col(k);
  JointVector nearest = JointVector::Constant(robot.size(), std::numeric_limits<double>::quiet_NaN());
  for (JointVector q : spuriousRests(run)) {
    for (int i = 0; i < robot.size(); ++i) {  // a turn more or less is the same place
      if (robot.joints[static_cast<std::size_t>(i)].kind == JointKind::kRevolute)
        q(i) = rest(i) - angleBetween(q(i), rest(i));
    }
    if (!nearest.allFinite() || (q - rest).norm() < (nearest - rest).norm()) nearest = q;
  }
  Checks checks;
  for (int i = 0; i < robot.size(); ++i) {
    checks.push_back(atRest(jointName(i) + " at the false rest", jointUnit(robot, i), nearest(i), rest(i)));
  }
  const Vector3 goal = goalOf(run).X_WE.p;
  checks.push_back(atRest("distance of the tip from its goal", "m", (goal - tipPose(robot, nearest).p).norm(),
                          (run.p_WE_d.col(k) - run.p_WE.col(k)).norm()));
  return checks;
}

// J_A^T Kp x~ = g - g_c + J_P^T h_e.
Checks taskBalance(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"operational_pd", "compliance"});
  constexpr std::array kNames{"x", "y", "z", "phi", "theta", "psi"};
  const RobotModel& robot = run.scenario.robot;
  const Reference goal = goalOf(run);
  const JointVector q = solve(effortAtRest(run), goal.q);
  const Vector6 predicted = zyzTaskError(goal, robot, q), measured = measuredError(run);
  Checks checks;
  for (int i = 0; i < 6; ++i) {
    checks.push_back(atRest(std::string("error of ") + kNames[static_cast<std::size_t>(i)] + " at rest",
                            i < 3 ? "m" : "rad", predicted(i), measured(i)));
  }
  for (int i = 0; i < robot.size(); ++i) {
    checks.push_back(atRest("error of " + jointName(i) + " at rest", jointUnit(robot, i), goal.q(i) - q(i),
                            goal.q(i) - run.q(i, restStep(run))));
  }
  for (Check& force : wallForcesAtRest(run, tipPose(robot, q).p)) checks.push_back(std::move(force));
  return checks;
}

// tau = g + J_A^T (Kp x~ - Kd J_A qd) in continuous time: the largest force on the way, beside the one at rest.
Checks complianceForce(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"compliance"});
  const RobotModel& robot = run.scenario.robot;
  const Vector6 kp = gain<Vector6>(run, "kp"), kd = gain<Vector6>(run, "kd");
  const Eigen::MatrixXd motion =
      motionUnder(run, [&](const Reference& wanted, const JointVector& q, const JointVector& qd) -> JointVector {
        const Eigen::MatrixXd J_A = zyzTaskJacobian(wanted, robot, q);
        return gravity(robot, q) +
               J_A.transpose() * (kp.cwiseProduct(zyzTaskError(wanted, robot, q)) - kd.cwiseProduct(Vector6(J_A * qd)));
      });
  const int n = robot.size();
  Largest predicted, measured, travel_in_contact;
  for (Eigen::Index k = 0; k <= restStep(run); ++k) {
    const JointVector q = motion.col(k).head(n);
    const double force = wallForce(run.scenario, tipPose(robot, q).p).norm();
    predicted.add(force);
    measured.add(run.h_e.col(k).head<3>().norm());
    if (force > 0.0)
      travel_in_contact.add((positionJacobian(robot, q) * motion.col(k).tail(n)).norm() * run.scenario.stepSeconds());
  }
  double Ke = 0.0;
  for (const PlaneSpec& wall : run.scenario.walls) Ke += wall.stiffness_N_per_m;
  // A torque held over a step acts half a step late: so much further the tip may have come.
  return {within("largest force on the way", "N", predicted, measured, Ke * travel_in_contact / 2.0)};
}

}  // namespace baton::theory
