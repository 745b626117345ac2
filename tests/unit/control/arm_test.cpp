/// The arm: its brake, the blend after a handover, its limits.
#include "control/arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "robot/dynamics.hpp"
#include "robot/simulation.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kBrakeRate = 20.0;    // 1/s, as arm.hpp says
constexpr std::uint64_t kBlend = 100;  // steps
const JointVector kStart = Vector3(0.3, 0.05, 0.1);

ArmConfig configOf(const JointVector& q, const JointVector& qd, double step_s = 5e-4) {
  return {.step_s = step_s, .start_q = q, .start_qd = qd};
}

/// Brakes for `steps` steps in free space.
void brake(Arm& arm, int steps) {
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(arm.move(arm.brakeEffort(), Contact{}));
}

TEST(ArmStart, IsTheScenariosWithTheTipWhereTheRobotPutsIt) {
  const RobotModel robot = test::rppRobot();
  const Arm arm(robot, configOf(kStart, Vector3(1.0, -0.2, 0.3)));
  EXPECT_EQ(arm.state().q, kStart);
  EXPECT_TRUE(arm.state().tau_applied.isZero(0.0));
  EXPECT_EQ(arm.state().X_WE.p, tipPose(robot, kStart).p);
  EXPECT_GT(arm.state().V_WE.norm(), 0.1);
}

TEST(ArmBrake, HoldsAnArmAtRestAgainstGravity) {
  const RobotModel robot = test::rppRobot();
  Arm arm(robot, configOf(kStart, JointVector::Zero(3)));
  brake(arm, 2000);
  // g(q) is computed by the same recursion as the motion: what is left is rounding of some 3 N m, over 0.04 kg and
  // integrated over a second.
  EXPECT_LT((arm.state().q - kStart).norm(), 1e-12);
}

TEST(ArmBrake, SpeedFallsAsTheExponentialWhereInertiaIsConstant) {
  // Joint 2 slides level and carries a constant mass. Torque is held over a step, so its speed falls by 1 - r dt a
  // step: the exponential's first terms.
  constexpr int kSteps = 200;
  const RobotModel robot = test::rppRobot();
  for (const double dt : {1e-3, 5e-4, 1e-4}) {
    Arm arm(robot, configOf(kStart, Vector3(0.0, 0.8, 0.0), dt));
    brake(arm, kSteps);
    const double fallen = arm.state().qd(1) / 0.8;
    EXPECT_NEAR(fallen, std::pow(1.0 - kBrakeRate * dt, kSteps), 1e-12);  // rounding of 200 steps
    // ln(1 - x) = -x - x^2/2 - ..., and x^3/3 stays below x^2/6 for x <= 0.02.
    const double relative = std::abs(fallen / std::exp(-kBrakeRate * dt * kSteps) - 1.0);
    EXPECT_LT(relative, kSteps * std::pow(kBrakeRate * dt, 2) * (0.5 + 1.0 / 6.0));
  }
}

/// Kinetic energy left after 0.1 s of braking, relative to what there was.
double energyLeft(const RobotModel& robot, const JointVector& q, const JointVector& qd, int steps) {
  Arm arm(robot, configOf(q, qd, 0.1 / steps));
  brake(arm, steps);
  return kineticEnergy(robot, arm.state().q, arm.state().qd) / kineticEnergy(robot, q, qd);
}

TEST(ArmBrake, KineticEnergyFallsAsTheSquareOfTheExponentialOnAnyArm) {
  // B qdd + C qd = -r B qd and the skew symmetry of dB/dt - 2C give dT/dt = -2 r T, whatever the arm and its motion.
  // The held torque adds an error that falls with the step, so the finer step must be nearer, by the ratio of the two.
  const double exact = std::exp(-2.0 * kBrakeRate * 0.1);
  for (unsigned seed = 0; seed < 5; ++seed) {
    const RobotModel robot = seed == 0 ? test::rppRobot() : test::randomChain(4, seed);
    std::mt19937 generator(seed);
    const JointVector q = test::randomJointVector(generator, robot.size(), 0.3);
    const JointVector qd = test::randomJointVector(generator, robot.size(), 0.5);
    const double coarse = energyLeft(robot, q, qd, 200) - exact;
    const double fine = energyLeft(robot, q, qd, 2000) - exact;
    EXPECT_LT(std::abs(fine), 0.02 * exact) << "seed " << seed;
    EXPECT_NEAR(fine / coarse, 0.1, 0.03) << "seed " << seed;
  }
}

TEST(ArmBlend, NothingJumpsAtTheHandoverAndNothingIsLeftAfterTheBlend) {
  const RobotModel robot = test::rppRobot();
  const ArmConfig config = configOf(kStart, JointVector::Zero(3));
  Arm arm(robot, config);
  const Vector3 tau_old(3.0, -1.0, 0.5), tau_new(-7.0, 4.0, 0.25);
  constexpr std::uint64_t kHandover = 1000;
  EXPECT_EQ(arm.blended(kHandover - 1, tau_old), tau_old);
  arm.blendFrom(kHandover, kBlend, tau_old - tau_new);
  EXPECT_LT((arm.blended(kHandover, tau_new) - tau_old).norm(), 1e-14);  // rounding of one subtraction and one sum
  const std::uint64_t over = kHandover + kBlend;
  EXPECT_EQ(arm.blended(over, tau_new), tau_new);
  EXPECT_NE(arm.blended(over - 1, tau_new), tau_new);
  // The quintic's slope is at most 15/8 of the mean slope.
  const double largest = 15.0 / 8.0 / static_cast<double>(kBlend);
  for (std::uint64_t step = kHandover; step < over; ++step) {
    const Vector3 change = arm.blended(step + 1, tau_new) - arm.blended(step, tau_new);
    EXPECT_LE(change.norm(), largest * (tau_old - tau_new).norm() * (1.0 + 1e-12));
  }
}

TEST(ArmBlend, AHandoverDuringABlendDoesNotJumpEither) {
  const RobotModel robot = test::rppRobot();
  Arm arm(robot, configOf(kStart, JointVector::Zero(3)));
  const Vector3 tau1(1.0, 2.0, 3.0), tau2(9.0, -5.0, 0.0), tau3(-4.0, 4.0, 8.0);
  arm.blendFrom(10, kBlend, tau1 - tau2);
  const Vector3 felt = arm.blended(60, tau2);
  arm.blendFrom(60, kBlend, felt - tau3);
  EXPECT_LT((arm.blended(60, tau3) - felt).norm(), 1e-14);
}

TEST(ArmMove, CutsEffortsAtTheJointsLimits) {
  RobotModel robot = test::rppRobot();
  const std::vector<double> limits{2.0, 1.0, 0.5};
  for (std::size_t i = 0; i < 3; ++i) robot.joints[i].effort_limit = limits[i];
  const ArmConfig config = configOf(kStart, JointVector::Zero(3));
  const JointVector within = Vector3(1.9, -0.9, 0.4), beyond = Vector3(50.0, -0.9, -70.0),
                    cut = Vector3(2.0, -0.9, -0.5);
  Arm arm(robot, config), same(robot, config);
  ASSERT_TRUE(arm.move(within, Contact{}));
  EXPECT_EQ(arm.state().tau_applied, within);

  ASSERT_TRUE(same.move(within, Contact{}));
  ASSERT_TRUE(arm.move(beyond, Contact{}));
  ASSERT_TRUE(same.move(cut, Contact{}));
  EXPECT_EQ(arm.state().tau_applied, cut);
  EXPECT_EQ(arm.state().q, same.state().q);
  EXPECT_EQ(arm.state().qd, same.state().qd);
}

TEST(ArmMove, IsTheIntegrationOfOneStepAndTheTipFollows) {
  const RobotModel robot = test::rppRobot();
  ArmConfig config = configOf(kStart, Vector3(0.4, -0.3, 0.2));
  config.substeps = 3;
  Arm arm(robot, config);
  Contact contact;
  contact.h_e << 1.0, 2.0, 3.0, 0.0, 0.0, 0.0;
  contact.df_dp = 100.0 * Matrix3::Identity();
  const JointVector tau = Vector3(1.0, 2.0, 3.0);
  JointVector q = kStart, qd = Vector3(0.4, -0.3, 0.2);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(arm.move(tau, contact));
    ASSERT_TRUE(integrateStep(robot, tau, contact, config.step_s, 3, q, qd));
  }
  EXPECT_EQ(arm.state().q, q);
  EXPECT_EQ(arm.state().qd, qd);
  EXPECT_EQ(arm.state().X_WE.p, tipPose(robot, q).p);
  EXPECT_EQ(arm.state().X_WE.R, tipPose(robot, q).R);
}

TEST(ArmMove, LeavesTheStateAsItWasWhenTheMotionIsNotFinite) {
  const RobotModel robot = test::rppRobot();
  Arm arm(robot, configOf(kStart, Vector3(0.4, -0.3, 0.2)));
  ASSERT_TRUE(arm.move(Vector3(1.0, 2.0, 3.0), Contact{}));
  const RobotState before = arm.state();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e308}) {
    EXPECT_FALSE(arm.move(Vector3(0.0, 0.0, bad), Contact{})) << bad;
    EXPECT_EQ(arm.state().q, before.q);
    EXPECT_EQ(arm.state().qd, before.qd);
    EXPECT_EQ(arm.state().tau_applied, before.tau_applied);
    EXPECT_EQ(arm.state().X_WE.p, before.X_WE.p);
  }
}

TEST(ArmHotPath, NeverAllocates) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  const RobotModel robot = test::rppRobot();
  Arm arm(robot, configOf(kStart, Vector3(0.4, -0.3, 0.2)));
  const JointVector r0 = Vector3(1.0, 2.0, 3.0);
  const test::AllocationGuard guard;
  arm.blendFrom(0, kBlend, r0);
  bool good = true;
  for (std::uint64_t step = 0; step < 200; ++step) {
    good = arm.move(arm.blended(step, arm.brakeEffort()), Contact{}) && good;
  }
  EXPECT_EQ(guard.count(), 0u);
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace baton
