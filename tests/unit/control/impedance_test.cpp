#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kMd = 1.0, kKd = 30.0, kKp = 200.0;  // the report's values and the law's defaults
constexpr double kKe = 200.0;                         // N/m
constexpr double kStep = 5e-4;                        // s
const JointVector kTarget = Vector3(kPi / 6, 0.2, 0.1);

/// The arm at rest against the wall.
struct Rest {
  JointVector q;
  Vector3 x_error;     // desired minus actual [m]
  Vector3 force;       // on the wall [N]
  Matrix3 compliance;  // J_P B^-1 J_P^T, how a force on the tip accelerates it [1/kg]
};

Rest restAgainstTheWall(const ParameterValues& parameters) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("impedance", robot, parameters), kStep, JointVector::Zero(3),
                  [&](double) { return setPoint(robot, kTarget); });
  loop.Ke_N_per_m = kKe;
  loop.run(8.0);
  EXPECT_LT(loop.input.state.qd.norm(), 1e-9);
  Kinematics kinematics;
  computeKinematics(robot, loop.q(), JointVector::Zero(3), kinematics);
  const Matrix3 J_P = kinematics.J.topRows<3>();
  const Matrix3 B_inverse_JT = massMatrixAt(robot, loop.q()).llt().solve(J_P.transpose());
  return {loop.q(), tipPose(robot, kTarget).p - loop.tip(), loop.force(), J_P * B_inverse_JT};
}

constexpr double kRestTolerance = 1e-8;  // N; the slowest pole is 10 1/s

TEST(Impedance, RestsWhereTheSpringCarriesTheContactForceAndOnlyInZ) {
  const Rest rest = restAgainstTheWall({});
  EXPECT_LT((kKp * rest.x_error - rest.force).norm(), kRestTolerance);
  // Two springs in series: Kp x~ = Ke (z_d - z_r - x~).
  const double depth_wanted = tipPose(rppRobot(), kTarget).p.z() - kWallHeight;
  EXPECT_NEAR(rest.x_error.z(), kKe * depth_wanted / (kKp + kKe), kRestTolerance / kKp);
  EXPECT_NEAR(rest.force.z(), 2.5, 0.01);
}

TEST(Impedance, PrintedFormRestsOffInXAsWell) {
  const Rest rest = restAgainstTheWall({{"form", "as_printed"}});
  EXPECT_LT((kKp * rest.x_error - 2.0 * kMd * rest.compliance * rest.force).norm(), kRestTolerance);
  EXPECT_GT(std::abs(rest.x_error.x()), 1e-3);
  EXPECT_GT(std::abs(rest.x_error.z()), 1e-3);
}

TEST(Impedance, WithoutForceFeedbackTheArmsOwnInertiaShapesTheOffset) {
  // B qdd + n = B y + n - J^T h_e, so at rest y = B^-1 J^T h_e and Kp x~ = Md J B^-1 J^T h_e.
  const Rest rest = restAgainstTheWall({{"form", "no_force"}});
  EXPECT_LT((kKp * rest.x_error - kMd * rest.compliance * rest.force).norm(), kRestTolerance);
  EXPECT_GT(std::abs(rest.x_error.x()), 1e-3);
}

TEST(Impedance, TipObeysItsMassSpringDamperAtEveryInstant) {
  // Md x~'' + Kd x~' + Kp x~ = h_e, the acceleration coming from the arm's forward dynamics.
  const RobotModel robot = rppRobot();
  const Vector3 md(0.7, 1.5, 2.0), kd(20.0, 30.0, 40.0), kp(150.0, 250.0, 350.0);
  const auto six = [](const Vector3& v) { return std::vector<double>{v(0), v(1), v(2), 1.0, 1.0, 1.0}; };
  const auto law = makeLaw("impedance", robot, {{"md", six(md)}, {"kd", six(kd)}, {"kp", six(kp)}});
  std::mt19937 generator(80);
  for (int i = 0; i < 100; ++i) {
    LawInput input;
    input.state = stateOf(robot, randomJointVector(generator, 3, 0.4), randomJointVector(generator, 3, 1.0));
    input.contact.h_e = randomJointVector(generator, 6, 10.0);
    input.reference = sineReference(robot, i);
    JointVector tau, qdd;
    ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
    ASSERT_TRUE(forwardDynamics(robot, input.state.q, input.state.qd, tau, input.contact.h_e, qdd));
    Kinematics kinematics;
    computeKinematics(robot, input.state.q, input.state.qd, kinematics);
    const Vector6 acceleration = kinematics.J * qdd + kinematics.Jdot_qd;
    const Vector3 x_error = input.reference.X_WE.p - input.state.X_WE.p;
    const Vector3 v_error = (input.reference.V_WE - input.state.V_WE).head<3>();
    const Vector3 a_error = (input.reference.A_WE - acceleration).head<3>();
    const Vector3 felt = md.cwiseProduct(a_error) + kd.cwiseProduct(v_error) + kp.cwiseProduct(x_error);
    EXPECT_LT((felt - input.contact.h_e.head<3>()).norm(), 1e-10 * (100.0 + felt.norm()));
  }
}

TEST(Impedance, SixDimensionalFormShapesTheWholePoseOfALongArm) {
  const RobotModel robot = randomRevoluteChain(7, 81);
  const auto law = makeLaw("impedance", robot, {{"solver", "pseudo_inverse"}});
  std::mt19937 generator(82);
  int solved = 0;
  for (int i = 0; i < 50; ++i) {
    LawInput input;
    input.state = stateOf(robot, randomJointVector(generator, 7, 1.0), randomJointVector(generator, 7, 1.0));
    input.contact.h_e = randomJointVector(generator, 6, 10.0);
    input.reference = setPoint(robot, input.state.q);  // no pose error: the wrench alone is left
    JointVector tau, qdd;
    if (law->step(input, tau) != LawStatus::kOk) continue;
    ++solved;
    ASSERT_TRUE(forwardDynamics(robot, input.state.q, input.state.qd, tau, input.contact.h_e, qdd));
    Kinematics kinematics;
    computeKinematics(robot, input.state.q, input.state.qd, kinematics);
    const Vector6 acceleration = kinematics.J * qdd + kinematics.Jdot_qd;
    const Vector6 felt = -kMd * acceleration - kKd * kinematics.V_WE;
    EXPECT_LT((felt - input.contact.h_e).norm(), 1e-7 * (1.0 + felt.norm()));
  }
  EXPECT_GE(solved, 40);
}

TEST(Impedance, FollowsAMotionInTheFree) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("impedance", robot, {}), kStep, sineReference(robot, 0.0).q,
                  [&](double t) { return sineReference(robot, t); });
  loop.run(3.0);
  // The reference is held for a step, half a step late on average: the tip lags by up to speed x step.
  EXPECT_LT((sineReference(robot, loop.time_s).X_WE.p - loop.tip()).norm(), 5e-4);
}

}  // namespace
}  // namespace baton
