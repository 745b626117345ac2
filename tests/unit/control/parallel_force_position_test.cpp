#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kKp = 100.0, kKd = 30.0, kKf = 0.05, kKi = 0.2;  // the report's values and the law's defaults
constexpr double kKe = 100.0;                                     // N/m
constexpr double kStep = 5e-4;                                    // s
const JointVector kTarget = Vector3(kPi / 6, 0.2, 0.1);
const JointVector kStart = Vector3(kPi / 6, 0.2, 0.0);

ClosedLoop parallelLoop(const RobotModel& robot, const Vector3& f_d, double dt_s, const JointVector& start) {
  ClosedLoop loop(robot, makeLaw("parallel_force_position", robot, {}), dt_s, start, [robot, f_d](double) {
    Reference reference = setPoint(robot, kTarget);
    reference.h_d.head<3>() = f_d;
    return reference;
  });
  loop.Ke_N_per_m = kKe;
  return loop;
}

TEST(ParallelForcePosition, ForceWinsInZAndPositionInXAndY) {
  for (const double f_d : {3.0, 6.0}) {
    ClosedLoop loop = parallelLoop(rppRobot(), {0.0, 0.0, f_d}, kStep, kStart);
    loop.run(12.0);
    const Vector3 x_d = tipPose(rppRobot(), kTarget).p;
    EXPECT_NEAR(loop.force().z(), f_d, 1e-6);
    EXPECT_LT((loop.tip() - x_d).head<2>().norm(), 1e-6);
    EXPECT_NEAR(x_d.z() - loop.tip().z(), x_d.z() - kWallHeight - f_d / kKe, 1e-8);
    EXPECT_LT(loop.input.state.qd.norm(), 1e-6);
  }
}

TEST(ParallelForcePosition, ReachesTheSetPointWhereThereIsNoWallAndNoForceIsAsked) {
  ClosedLoop loop = parallelLoop(rppRobot(), Vector3::Zero(), kStep, kStart);
  loop.Ke_N_per_m = 0.0;
  loop.run(10.0);
  EXPECT_LT((loop.q() - kTarget).norm(), 1e-6);
}

TEST(ParallelForcePosition, StartsWithAnEmptyIntegral) {
  // From rest on the goal, in the free: Kp Kf f_d is all that moves the tip, at once.
  const RobotModel robot = rppRobot();
  ClosedLoop loop = parallelLoop(robot, {0.0, 0.5, 0.0}, kStep, kTarget);
  loop.Ke_N_per_m = 0.0;
  ASSERT_TRUE(loop.step());
  Kinematics kinematics;
  computeKinematics(robot, kTarget, JointVector::Zero(3), kinematics);
  const JointVector y = massMatrixAt(robot, kTarget).llt().solve(loop.tau - gravityAt(robot, kTarget));
  EXPECT_LT((kinematics.J.topRows<3>() * y - Vector3(0.0, kKp * kKf * 0.5, 0.0)).norm(), 1e-12);
}

/// Largest distance over 1 s between the simulated height and
///   x'' = -Kd x' + Kp (x_d + Kf (f_d - f_e) + w - x),   w' = Ki (f_d - f_e),   f_e = Ke (x - z_r),
/// integrated finely. The arm starts on the goal, in contact, and stays there.
double discrepancy(double dt_s) {
  constexpr double kForce = 3.0;
  ClosedLoop loop = parallelLoop(rppRobot(), {0.0, 0.0, kForce}, dt_s, kTarget);
  const double z_d = loop.tip().z();
  const auto rate = [&](const Vector3& s) {  // height, its rate, w
    const double f_error = kForce - kKe * (s(0) - kWallHeight);
    return Vector3(s(1), -kKd * s(1) + kKp * (z_d + kKf * f_error + s(2) - s(0)), kKi * f_error);
  };
  Vector3 s(z_d, 0.0, 0.0);
  double largest = 0.0;
  while (loop.time_s < 1.0) {
    EXPECT_TRUE(loop.step());
    constexpr int kFine = 4;  // RK4 at an eighth of a millisecond and less: 1e-12
    const double h = dt_s / kFine;
    for (int i = 0; i < kFine; ++i) {
      const Vector3 k1 = rate(s), k2 = rate(s + 0.5 * h * k1), k3 = rate(s + 0.5 * h * k2), k4 = rate(s + h * k3);
      s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    EXPECT_GT(loop.tip().z(), kWallHeight);
    largest = std::max(largest, std::abs(loop.tip().z() - s(0)));
  }
  return largest;
}

TEST(ParallelForcePosition, HeightFollowsItsLinearEquationToFirstOrderInTheStep) {
  const double one = discrepancy(1e-3), half = discrepancy(5e-4), quarter = discrepancy(2.5e-4);
  EXPECT_LT(half, 1e-4);
  EXPECT_NEAR(one / half, 2.0, 0.15);
  EXPECT_NEAR(half / quarter, 2.0, 0.1);
}

TEST(ParallelForcePosition, DoesNotWindUpAgainstAnEffortLimit) {
  // A shoulder too weak for the force asked, for 5 s; then it is strong again. Returns the peak force after that.
  const auto peak = [](bool knows_limit) {
    RobotModel weak = rppRobot();
    weak.joints[0].effort_limit = 4.8;  // gravity takes 4.1 N m, 3 N on the wall 1.4 N m more
    ClosedLoop loop = parallelLoop(weak, {0.0, 0.0, 3.0}, kStep, kStart);
    if (!knows_limit) loop.law = makeLaw("parallel_force_position", rppRobot(), {});
    loop.run(5.0);
    loop.model.joints[0].effort_limit = 100.0;
    double highest = 0.0;
    while (loop.time_s < 12.0) {
      EXPECT_TRUE(loop.step());
      highest = std::max(highest, loop.force().z());
    }
    EXPECT_NEAR(loop.force().z(), 3.0, 1e-3);
    return highest;
  };
  const double told = peak(true);
  EXPECT_LT(told, 4.0);  // a strong arm's first touch, from the same start, peaks at 4.2 N
  EXPECT_GT(peak(false), 5 * told);
}

TEST(ParallelForcePosition, HandoverMatchesTheEffortThatWasHeld) {
  const RobotModel robot = rppRobot();
  const auto law = makeLaw("parallel_force_position", robot, {});
  std::mt19937 generator(130);
  for (int i = 0; i < 100; ++i) {
    LawInput input;
    input.dt_s = kStep;
    input.state = stateOf(robot, randomJointVector(generator, 3, 0.4), randomJointVector(generator, 3, 1.0));
    input.state.tau_applied = randomJointVector(generator, 3, 20.0);
    input.contact.h_e.z() = uniform(generator, 0.0, 10.0);
    input.reference = setPoint(robot, kTarget);
    input.reference.h_d.z() = 3.0;
    law->handover(input);
    JointVector tau;
    ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
    EXPECT_LT((tau - input.state.tau_applied).norm(), 1e-10);  // 20 N m x rounding x the condition of B and J_P
  }
}

}  // namespace
}  // namespace baton
