#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kKp = 100.0, kKd = 30.0, kKf = 0.05, kKi = 0.2;  // the report's values and the law's defaults
constexpr double kKe = 100.0;                                     // N/m
constexpr double kStep = 5e-4;                                    // s
const JointVector kStart = Vector3(kPi / 6, 0.2, 0.0);

Reference forceReference(const Vector3& f_d) {
  Reference reference;  // a wrench is all the law reads
  reference.h_d.head<3>() = f_d;
  return reference;
}

ClosedLoop forceLoop(const RobotModel& robot, const Vector3& f_d, const ParameterValues& parameters = {}) {
  ClosedLoop loop(robot, makeLaw("force_pi", robot, parameters), kStep, kStart,
                  [f_d](double) { return forceReference(f_d); });
  loop.Ke_N_per_m = kKe;
  return loop;
}

TEST(ForcePi, ReachesTheDesiredForce) {
  for (const double f_d : {3.0, 6.0}) {
    ClosedLoop loop = forceLoop(rppRobot(), {0.0, 0.0, f_d});
    const Vector3 start = loop.tip();
    loop.run(10.0);
    EXPECT_NEAR(loop.force().z(), f_d, 1e-6);  // the slowest pole of s^3 + 30 s^2 + 600 s + 2000 is 3.9 1/s
    EXPECT_NEAR(loop.tip().z(), kWallHeight + f_d / kKe, 1e-8);
    EXPECT_LT((loop.tip() - start).head<2>().norm(), 1e-9);
    EXPECT_LT(loop.input.state.qd.norm(), 1e-7);
  }
}

TEST(ForcePi, AtRestTheTipIsWhereTheForceLoopWantsIt) {
  // x_F is not visible, but at rest the law's effort is n + J^T h_e + B J_P^-1 Kp (x_F - x) / Md: no surplus, x_F = x.
  const RobotModel robot = rppRobot();
  ClosedLoop loop = forceLoop(robot, {0.0, 0.0, 3.0});
  loop.run(10.0);
  Kinematics kinematics;
  computeKinematics(robot, loop.q(), JointVector::Zero(3), kinematics);
  Vector6 h_e = Vector6::Zero();
  h_e.head<3>() = loop.force();
  const JointVector surplus = loop.tau - gravityAt(robot, loop.q()) - kinematics.J.transpose() * h_e;
  const Vector3 acceleration = kinematics.J.topRows<3>() * massMatrixAt(robot, loop.q()).llt().solve(surplus);
  EXPECT_LT(acceleration.norm() / kKp, 1e-7);
}

TEST(ForcePi, StartsWithoutALeap) {
  // x_F(0) = x_e(0) and no motion: the first effort holds the arm and the contact, no more.
  const RobotModel robot = rppRobot();
  ClosedLoop loop = forceLoop(robot, {1.0, -2.0, 3.0});
  ASSERT_TRUE(loop.step());
  EXPECT_LT((loop.tau - gravityAt(robot, kStart)).norm(), 1e-12);
}

/// Largest distance over 1 s between the simulated height and
///   x'' = -Kd x' + Kp (Kf (f_d - f_e) + w - x),   w' = Ki (f_d - f_e),   f_e = Ke (x - z_r),
/// integrated finely. The arm starts at rest and in contact, x_F on the tip, and stays in contact.
double discrepancy(double dt_s) {
  static constexpr double kForce = 3.0;
  ClosedLoop loop(rppRobot(), makeLaw("force_pi", rppRobot(), {}), dt_s, Vector3(kPi / 6, 0.2, 0.1), [](double) {
    return forceReference({0.0, 0.0, kForce});
  });
  loop.Ke_N_per_m = kKe;
  const auto forceError = [](double height) { return kForce - kKe * (height - kWallHeight); };
  const auto rate = [&](const Vector3& s) {  // height, its rate, w
    return Vector3(s(1), -kKd * s(1) + kKp * (kKf * forceError(s(0)) + s(2) - s(0)), kKi * forceError(s(0)));
  };
  const double start = loop.tip().z();
  Vector3 s(start, 0.0, start - kKf * forceError(start));
  double largest = 0.0;
  while (loop.time_s < 1.0) {
    EXPECT_TRUE(loop.step());
    constexpr int kFine = 4;  // RK4 at a quarter of a millisecond and less: 1e-12
    const double h = dt_s / kFine;
    for (int i = 0; i < kFine; ++i) {
      const Vector3 k1 = rate(s), k2 = rate(s + 0.5 * h * k1), k3 = rate(s + 0.5 * h * k2), k4 = rate(s + h * k3);
      s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    EXPECT_GT(loop.tip().z(), kWallHeight);
    largest = std::max(largest, std::abs(loop.tip().z() - s(0)));
  }
  EXPECT_GT(std::abs(loop.tip().z() - start), 1e-3) << "something must have moved";
  return largest;
}

TEST(ForcePi, HeightFollowsItsLinearEquationToFirstOrderInTheStep) {
  const double one = discrepancy(1e-3), half = discrepancy(5e-4), quarter = discrepancy(2.5e-4);
  EXPECT_LT(half, 1e-4);
  EXPECT_NEAR(one / half, 2.0, 0.15);
  EXPECT_NEAR(half / quarter, 2.0, 0.1);
}

TEST(ForcePi, DriftsSteadilyWhereNothingPushesBack) {
  ClosedLoop loop = forceLoop(rppRobot(), {0.0, 1.0, 3.0});
  loop.run(8.0);
  EXPECT_NEAR(loop.input.state.V_WE(1), kKi * 1.0, 1e-6);
  EXPECT_NEAR(loop.force().z(), 3.0, 1e-6);  // untouched by the drift
}

/// An arm whose shoulder is too weak for the force asked; `told` says whether the law learns what was really applied.
/// Returns the largest effort the shoulder was asked for, and the peak force once the shoulder is strong again.
std::pair<double, double> weakShoulder(bool told) {
  RobotModel robot = rppRobot();
  robot.joints[0].effort_limit = 4.8;  // gravity takes 4.1 N m, 3 N on the wall 1.4 N m more
  ClosedLoop loop = forceLoop(robot, {0.0, 0.0, 3.0});
  double asked = 0.0, peak = 0.0;
  for (int k = 0; k < 10000; ++k) {
    EXPECT_TRUE(loop.step());
    if (!told) loop.input.state.tau_applied = loop.tau;
    asked = std::max(asked, loop.tau(0));
  }
  loop.model.joints[0].effort_limit = 100.0;
  for (int k = 0; k < 10000; ++k) {
    EXPECT_TRUE(loop.step());
    peak = std::max(peak, loop.force().z());
  }
  EXPECT_NEAR(loop.force().z(), 3.0, 1e-3);
  return {asked, peak};
}

TEST(ForcePi, DoesNotWindUpAgainstAnEffortLimit) {
  const auto [asked_told, peak_told] = weakShoulder(true);
  const auto [asked_untold, peak_untold] = weakShoulder(false);
  EXPECT_LT(asked_told, 10.0);              // waits not far above the limit
  EXPECT_GT(asked_untold, 3 * asked_told);  // wound up
  EXPECT_LT(peak_told, 3.1);                // comes free without a blow
  EXPECT_GT(peak_untold, 3 * peak_told);
}

TEST(ForcePi, IntegratesOnWhileAHandoversRemainderFades) {
  // The plant adds a remainder to the effort: what is applied is not what was commanded, but no limit cut it.
  RobotModel robot = rppRobot();
  robot.joints[0].effort_limit = 20.0;
  ClosedLoop faded = forceLoop(robot, {0.0, 0.0, 3.0}), plain = forceLoop(robot, {0.0, 0.0, 3.0});
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(faded.step());
    ASSERT_TRUE(plain.step());
    faded.input.state.tau_applied.array() -= 1.0;
    ASSERT_EQ(faded.tau, plain.tau);
  }
}

TEST(ForcePi, HandoverMatchesTheEffortThatWasHeld) {
  // Three joints, three integrals: any effort can be matched.
  const RobotModel robot = rppRobot();
  const auto law = makeLaw("force_pi", robot, {});
  std::mt19937 generator(90);
  for (int i = 0; i < 100; ++i) {
    LawInput input;
    input.dt_s = kStep;
    input.state = stateOf(robot, randomJointVector(generator, 3, 0.4), randomJointVector(generator, 3, 1.0));
    input.state.tau_applied = randomJointVector(generator, 3, 20.0);
    input.contact.h_e.z() = uniform(generator, 0.0, 10.0);
    input.reference = forceReference({0.0, 0.0, 3.0});
    law->handover(input);
    JointVector tau;
    ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
    EXPECT_LT((tau - input.state.tau_applied).norm(), 1e-10);  // 20 N m x rounding x the condition of B and J_P
  }
}

TEST(ForcePi, HandoverOfALongArmMatchesTheTipsAcceleration) {
  const RobotModel robot = randomRevoluteChain(6, 91);
  const auto law = makeLaw("force_pi", robot, {});
  std::mt19937 generator(92);
  int solved = 0;
  for (int i = 0; i < 50; ++i) {
    LawInput input;
    input.dt_s = kStep;
    input.state = stateOf(robot, randomJointVector(generator, 6, 1.0), randomJointVector(generator, 6, 1.0));
    input.state.tau_applied = randomJointVector(generator, 6, 20.0);
    law->handover(input);
    JointVector tau;
    if (law->step(input, tau) != LawStatus::kOk) continue;
    ++solved;
    Kinematics kinematics;
    computeKinematics(robot, input.state.q, input.state.qd, kinematics);
    const JointVector difference = massMatrixAt(robot, input.state.q).llt().solve(tau - input.state.tau_applied);
    EXPECT_LT((kinematics.J.topRows<3>() * difference).norm(), 1e-6);
  }
  EXPECT_GE(solved, 45);
}

TEST(ForcePi, GoesOnFromAHandoverWithoutAJump) {
  // An impedance law presses, then force control takes over in mid-motion: the effort goes on where it was.
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("impedance", robot, {}), kStep, JointVector::Zero(3), [&](double) {
    Reference reference = setPoint(robot, Vector3(kPi / 6, 0.2, 0.1));
    reference.h_d.z() = 3.0;
    return reference;
  });
  loop.Ke_N_per_m = kKe;
  loop.run(0.4);
  ASSERT_GT(loop.force().z(), 0.1);
  ASSERT_GT(loop.input.state.V_WE.norm(), 0.01);
  const JointVector before = loop.tau;
  loop.law = makeLaw("force_pi", robot, {});
  loop.input.contact = wallContact(kKe, loop.tip());
  loop.law->handover(loop.input);
  ASSERT_TRUE(loop.step());
  EXPECT_LT((loop.tau - before).norm(), 1e-10);
  loop.run(10.0);
  EXPECT_NEAR(loop.force().z(), 3.0, 1e-6);
}

}  // namespace
}  // namespace baton
