#include <gtest/gtest.h>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kStep = 2.5e-4;    // s; Kd / m3 = 1500 1/s is the fastest pole
constexpr double kKp = 90.0;        // the report's gain and the law's default
constexpr double kDuration = 15.0;  // s; the slowest pole is about 1.4 1/s: e^-21 of the start is left
// What is left of the start, times Kp: 90 x 7e-10, and some.
constexpr double kRestTolerance = 2e-7;  // N m or N

const JointVector kTarget = Vector3(kPi / 3, 0.1, 0.1);

/// q once the law has brought the arm to rest.
JointVector restingPosition(const ParameterValues& parameters) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("joint_pd", robot, parameters), kStep, JointVector::Zero(3),
                  [&](double) { return setPoint(robot, kTarget); });
  loop.run(kDuration);
  EXPECT_LT(loop.input.state.qd.norm(), 1e-8);
  return loop.q();
}

TEST(JointPd, ReachesTheSetPointWithGravityCompensation) {
  const JointVector e = kTarget - restingPosition({});
  EXPECT_LT(kKp * e.norm(), kRestTolerance);
}

TEST(JointPd, WithoutGravityRestsWhereStiffnessCarriesGravity) {
  const RobotModel robot = rppRobot();
  const JointVector q = restingPosition({{"gravity", "none"}});
  const JointVector e = kTarget - q;
  EXPECT_LT((kKp * e - gravityAt(robot, q)).norm(), kRestTolerance);
  // Gravity pulls on joints 1 and 3, not along joint 2, which slides level.
  EXPECT_GT(std::abs(e(0)), 0.02);
  EXPECT_LT(kKp * std::abs(e(1)), kRestTolerance);
  EXPECT_GT(std::abs(e(2)), 0.003);
}

TEST(JointPd, WithFixedGravityRestsWhereStiffnessCarriesTheDifference) {
  const RobotModel robot = rppRobot();
  const JointVector fixed = Vector3(0.3, 0.0, 0.05);
  const JointVector q =
      restingPosition({{"gravity", "fixed"}, {"gravity_position", std::vector<double>{0.3, 0.0, 0.05}}});
  EXPECT_LT((kKp * (kTarget - q) - gravityAt(robot, q) + gravityAt(robot, fixed)).norm(), kRestTolerance);
  EXPECT_GT((kTarget - q).norm(), 0.01);
}

TEST(JointPd, WithScaledMassesRestsWhereStiffnessCarriesTheExcess) {
  const RobotModel robot = rppRobot();
  const JointVector q = restingPosition({{"mass_scale", std::vector<double>{1.2}}});
  EXPECT_LT((kKp * (kTarget - q) + 0.2 * gravityAt(robot, q)).norm(), kRestTolerance);
}

TEST(JointPd, EffortIsTheEquation) {
  const RobotModel robot = randomChain(6, 11);
  const auto law = makeLaw("joint_pd", robot, {{"kp", std::vector<double>{1, 2, 3, 4, 5, 6}}});
  std::mt19937 generator(12);
  for (int i = 0; i < 50; ++i) {
    LawInput input;
    input.state = stateOf(robot, randomJointVector(generator, 6, 1.0), randomJointVector(generator, 6, 1.0));
    input.reference.q = randomJointVector(generator, 6, 1.0);
    JointVector tau;
    ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
    const JointVector g = gravityAt(robot, input.state.q);
    for (int j = 0; j < 6; ++j) {
      const double expected = g(j) + (j + 1) * (input.reference.q(j) - input.state.q(j)) - 60.0 * input.state.qd(j);
      EXPECT_NEAR(tau(j), expected, 1e-12 * (1.0 + std::abs(expected) + std::abs(g(j))));  // a few roundings
    }
  }
}

TEST(JointPd, LosesEnergyAtTheRateOfItsDamping) {
  // V = kinetic energy + e^T Kp e / 2 falls at qd^T Kd qd when gravity is compensated: Lyapunov's proof of the law.
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("joint_pd", robot, {}), kStep / 5, JointVector::Zero(3),
                  [&](double) { return setPoint(robot, kTarget); });
  const auto energy = [&] {
    const JointVector e = kTarget - loop.q();
    return kineticEnergy(robot, loop.q(), loop.input.state.qd) + 0.5 * kKp * e.squaredNorm();
  };
  const double start = energy();
  double dissipated = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const JointVector before = loop.input.state.qd;
    ASSERT_TRUE(loop.step());
    dissipated += 60.0 * loop.dt_s * 0.5 * (before.squaredNorm() + loop.input.state.qd.squaredNorm());
  }
  // Holding the torque over a step of 50 us against a pole of 1500 1/s costs a few per cent of the small, fast part.
  EXPECT_NEAR(energy() + dissipated, start, 0.01 * start);
}

}  // namespace
}  // namespace baton
