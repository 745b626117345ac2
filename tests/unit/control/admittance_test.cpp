#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kMt = 1.0, kKdt = 30.0, kKpt = 200.0;  // the report's values and the law's defaults
constexpr double kKe = 200.0;                           // N/m
constexpr double kStep = 5e-4;                          // s
const JointVector kTarget = Vector3(kPi / 6, 0.2, 0.1);

ClosedLoop admittanceLoop(double dt_s, const JointVector& start, const ParameterValues& parameters = {}) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("admittance", robot, parameters), dt_s, start,
                  [robot](double) { return setPoint(robot, kTarget); });
  loop.Ke_N_per_m = kKe;
  return loop;
}

TEST(Admittance, RestsWhereTheFramesSpringCarriesTheContactForceAndOnlyInZ) {
  for (const char* solver : {"position", "pseudo_inverse"}) {
    ClosedLoop loop = admittanceLoop(kStep, JointVector::Zero(3), {{"solver", solver}});
    loop.run(10.0);
    EXPECT_LT(loop.input.state.qd.norm(), 1e-8) << solver;
    if (std::string(solver) != "position") continue;  // the tip's turn holds part of x~ back
    const Vector3 x_error = tipPose(rppRobot(), kTarget).p - loop.tip();
    EXPECT_LT((kKpt * x_error - loop.force()).norm(), 1e-7);
    const double depth_wanted = tipPose(rppRobot(), kTarget).p.z() - kWallHeight;
    EXPECT_NEAR(x_error.z(), kKe * depth_wanted / (kKpt + kKe), 1e-9);
  }
}

/// Largest distance over 0.5 s between the simulated x~ and Mt x~'' + Kdt x~' + Kpt x~ = Ke (z_d - z_r - x~) solved by
/// hand. The arm starts on the goal, so in contact with the frame on the tip.
double discrepancy(double dt_s) {
  ClosedLoop loop = admittanceLoop(dt_s, kTarget);
  const double z_d = loop.tip().z(), depth = z_d - kWallHeight;
  EXPECT_GT(depth, 0.01);
  const double rest = kKe * depth / (kKpt + kKe);
  const double sigma = kKdt / (2 * kMt), w = std::sqrt((kKpt + kKe) / kMt - sigma * sigma);
  double largest = 0.0;
  while (loop.time_s < 0.5) {
    EXPECT_TRUE(loop.step());
    const double t = loop.time_s;
    const double expected = rest * (1.0 - std::exp(-sigma * t) * (std::cos(w * t) + sigma / w * std::sin(w * t)));
    largest = std::max(largest, std::abs(z_d - loop.tip().z() - expected));
  }
  return largest;
}

TEST(Admittance, TipAnswersAsTheFrameToFirstOrderInTheStep) {
  const double one = discrepancy(1e-3), half = discrepancy(5e-4), quarter = discrepancy(2.5e-4);
  EXPECT_LT(half, 1e-3 * 0.0125);  // of the motion
  EXPECT_NEAR(one / half, 2.0, 0.2);
  EXPECT_NEAR(half / quarter, 2.0, 0.15);
}

TEST(Admittance, FollowsAMotionInTheFree) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("admittance", robot, {}), kStep, sineReference(robot, 0.0).q,
                  [&](double t) { return sineReference(robot, t); });
  loop.run(3.0);
  // The reference is held for a step, half a step late on average: the tip lags by up to speed x step.
  EXPECT_LT((sineReference(robot, loop.time_s).X_WE.p - loop.tip()).norm(), 5e-4);
}

TEST(Admittance, WithoutSpringAHandLeadsTheFrame) {
  // A steady pull of 2 N on the tip: the frame drifts at f / Kdt, against the force the tip exerts.
  const RobotModel robot = rppRobot();
  const auto law = makeLaw("admittance", robot, {{"kpt", std::vector<double>{0.0}}});
  LawInput input;
  input.dt_s = kStep;
  input.state = stateOf(robot, kTarget, JointVector::Zero(3));
  Contact pull;
  pull.h_e.y() = -2.0;
  JointVector tau;
  for (int k = 0; k < 6000; ++k) {
    input.contact = pull;
    input.reference = setPoint(robot, kTarget);
    ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
    JointVector q = input.state.q, qd = input.state.qd;
    ASSERT_TRUE(integrateStep(robot, tau, pull, kStep, 1, q, qd));
    input.state = stateOf(robot, q, qd);
  }
  EXPECT_NEAR(input.state.V_WE(1), 2.0 / kKdt, 1e-6);
}

LawInput randomHandover(const RobotModel& robot, std::mt19937& generator, double spread) {
  const int n = robot.size();
  LawInput input;
  input.dt_s = kStep;
  input.state = stateOf(robot, randomJointVector(generator, n, spread), randomJointVector(generator, n, 1.0));
  input.state.tau_applied = randomJointVector(generator, n, 20.0);
  input.contact.h_e.z() = uniform(generator, 0.0, 10.0);
  input.reference = sineReference(robot, uniform(generator, 0.0, 5.0));
  return input;
}

TEST(Admittance, HandoverMatchesTheEffortThatWasHeldWhateverTheSolver) {
  // Three joints, three coordinates of the frame: any effort can be matched.
  const RobotModel robot = rppRobot();
  for (const char* solver : {"position", "pseudo_inverse", "damped_least_squares"}) {
    const auto law = makeLaw("admittance", robot, {{"solver", solver}});
    std::mt19937 generator(120);
    for (int i = 0; i < 100; ++i) {
      const LawInput input = randomHandover(robot, generator, 0.4);
      law->handover(input);
      JointVector tau;
      ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
      EXPECT_LT((tau - input.state.tau_applied).norm(), 1e-8) << solver;  // rounding x conditions of B, J_P, response
    }
  }
}

TEST(Admittance, HandoverWorksWhereTheLoopsAreEquallyStiff) {
  // Kpt / Mt = Kp: z alone could not match, z' can.
  const RobotModel robot = rppRobot();
  const auto law = makeLaw("admittance", robot, {{"kpt", std::vector<double>{2500.0}}});
  std::mt19937 generator(121);
  const LawInput input = randomHandover(robot, generator, 0.4);
  law->handover(input);
  JointVector tau;
  ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
  EXPECT_LT((tau - input.state.tau_applied).norm(), 1e-9);
}

TEST(Admittance, HandoverOfALongArmMatchesTheTipsAcceleration) {
  const RobotModel robot = randomRevoluteChain(6, 122);
  const auto law = makeLaw("admittance", robot, {});
  std::mt19937 generator(123);
  int solved = 0;
  for (int i = 0; i < 50; ++i) {
    const LawInput input = randomHandover(robot, generator, 1.0);
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

TEST(Admittance, GoesOnFromAHandoverWithoutAJump) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("impedance", robot, {}), kStep, JointVector::Zero(3),
                  [&](double) { return setPoint(robot, kTarget); });
  loop.Ke_N_per_m = kKe;
  loop.run(0.35);
  ASSERT_GT(loop.force().z(), 0.1);
  ASSERT_GT(loop.input.state.V_WE.norm(), 0.01);
  const JointVector before = loop.tau;
  loop.law = makeLaw("admittance", robot, {});
  loop.input.contact = wallContact(kKe, loop.tip());
  loop.law->handover(loop.input);
  ASSERT_TRUE(loop.step());
  EXPECT_LT((loop.tau - before).norm(), 1e-9);
  const Vector3 at_handover = loop.tip();
  loop.run(0.05);
  EXPECT_LT((loop.tip() - at_handover).norm(), 0.1);
  loop.run(10.0);
  EXPECT_LT((kKpt * (tipPose(robot, kTarget).p - loop.tip()) - loop.force()).norm(), 1e-6);
}

}  // namespace
}  // namespace baton
