#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kKp = 200.0, kKd = 70.0;  // the report's gains and the law's defaults
constexpr double kStep = 5e-4;             // s
constexpr double kDuration = 10.0;         // s; the slow pole is 2.98 1/s: 1e-13 of the start is left
constexpr double kRestTolerance = 1e-9;    // N m or N

const JointVector kTarget = Vector3(kPi / 3, 0.1, 0.1);

JointVector restingPosition(const ParameterValues& parameters) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("joint_inverse_dynamics", robot, parameters), kStep, JointVector::Zero(3),
                  [&](double) { return setPoint(robot, kTarget); });
  loop.run(kDuration);
  return loop.q();
}

TEST(JointInverseDynamics, MakesTheArmAccelerateAsTheErrorDynamicsAsk) {
  for (const int n : {1, 3, 5, 8}) {
    const RobotModel robot = randomChain(n, 20 + n);
    const auto law = makeLaw("joint_inverse_dynamics", robot, {});
    std::mt19937 generator(n);
    for (int i = 0; i < 50; ++i) {
      LawInput input;
      input.state = stateOf(robot, randomJointVector(generator, n, 2.0), randomJointVector(generator, n, 2.0));
      input.reference = sineReference(robot, i);
      JointVector tau;
      ASSERT_EQ(law->step(input, tau), LawStatus::kOk);

      const JointVector& q = input.state.q;
      const JointVector& qd = input.state.qd;
      const JointVector y = input.reference.qdd + kKd * (input.reference.qd - qd) + kKp * (input.reference.q - q);
      const JointVector qdd = massMatrixAt(robot, q).llt().solve(tau - biasAt(robot, q, qd));
      EXPECT_LT((qdd - y).norm(), 1e-10 * y.norm());  // rounding times the condition of B, up to 1e4 here
    }
  }
}

TEST(JointInverseDynamics, ReachesTheSetPoint) {
  EXPECT_LT(kKp * (kTarget - restingPosition({})).norm(), kRestTolerance);
}

TEST(JointInverseDynamics, WithScaledMassesRestsAtTheOffsetTheoryGives) {
  const RobotModel robot = rppRobot();
  const JointVector q = restingPosition({{"mass_scale", std::vector<double>{1.2}}});
  const JointVector weight = massMatrixAt(robot, q).llt().solve(gravityAt(robot, q));
  EXPECT_LT((kKp * (kTarget - q) - (1.0 / 1.2 - 1.0) * weight).norm(), kRestTolerance);
  EXPECT_GT((kTarget - q).norm(), 1e-3);
}

TEST(JointInverseDynamics, WithoutInertiaStillReachesTheSetPoint) {
  EXPECT_LT(kKp * (kTarget - restingPosition({{"model", "ignore_inertia"}})).norm(), kRestTolerance);
}

TEST(JointInverseDynamics, WithoutBiasRestsWhereInertiaTimesStiffnessCarriesGravity) {
  const RobotModel robot = rppRobot();
  const JointVector q = restingPosition({{"model", "ignore_bias"}});
  EXPECT_LT((massMatrixAt(robot, q) * kKp * (kTarget - q) - gravityAt(robot, q)).norm(), kRestTolerance);
}

TEST(JointInverseDynamics, WithoutBothRestsWhereStiffnessCarriesGravity) {
  const RobotModel robot = rppRobot();
  const JointVector q = restingPosition({{"model", "ignore_both"}});
  EXPECT_LT((kKp * (kTarget - q) - gravityAt(robot, q)).norm(), kRestTolerance);
  // Less inertia than 1 on every joint but the second, so less offset than with B in the law.
  const JointVector with_inertia = restingPosition({{"model", "ignore_bias"}});
  EXPECT_LT((kTarget - q).norm(), (kTarget - with_inertia).norm());
}

TEST(JointInverseDynamics, SaturatedStepPeaksAtTheEquationAndStillSettles) {
  // From rest at zero, tau(0) = B Kp q_d + g: the 713 N m peak of the report's Figure 14.
  RobotModel robot = rppRobot();
  const ParameterValues stiff = {{"kp", std::vector<double>{2000.0}}, {"kd", std::vector<double>{90.0}}};
  const JointVector zero = JointVector::Zero(3);
  for (const bool limited : {false, true}) {
    if (limited) {
      robot.joints[0].effort_limit = 20.0;
      robot.joints[1].effort_limit = 10.0;
      robot.joints[2].effort_limit = 1.0;
    }
    ClosedLoop loop(robot, makeLaw("joint_inverse_dynamics", robot, stiff), kStep, zero,
                    [&](double) { return setPoint(robot, kTarget); });
    ASSERT_TRUE(loop.step());
    const Vector3 peak = massMatrixAt(robot, zero) * 2000.0 * kTarget + gravityAt(robot, zero);
    EXPECT_LT((loop.tau - peak).norm(), 1e-10);
    EXPECT_NEAR(loop.tau(0), 713.0, 1.0);
    loop.run(5.0);
    EXPECT_LT((kTarget - loop.q()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace baton
