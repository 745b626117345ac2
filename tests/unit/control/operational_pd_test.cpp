#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kStep = 1e-4;                                              // s; Kd / m3 = 3700 1/s is the fastest pole
constexpr double kKp = 200.0, kKpTurn = 50.0, kKd = 150.0, kKdTurn = 20.0;  // the report's values and the defaults
const JointVector kTarget = Vector3(kPi / 6, 0.2, 0.1);

Vector6 gains(double linear, double angular) {
  Vector6 k;
  k << Vector3::Constant(linear), Vector3::Constant(angular);
  return k;
}

ClosedLoop pdLoop(const JointVector& start, const ParameterValues& parameters = {}) {
  const RobotModel robot = rppRobot();
  return {robot, makeLaw("operational_pd", robot, parameters), kStep, start,
          [robot](double) { return setPoint(robot, kTarget); }};
}

/// J_A^T Kp x~ where the arm rests, ZYZ angles.
JointVector springEffort(const JointVector& q) {
  const RobotModel robot = rppRobot();
  Kinematics kinematics;
  computeKinematics(robot, q, JointVector::Zero(3), kinematics);
  Jacobian J_A;
  EXPECT_TRUE(analyticalJacobian(kinematics, J_A));
  const Pose X_WD = tipPose(robot, kTarget);
  Vector6 error;
  error << X_WD.p - kinematics.X_WE.p, zyzFromRotation(X_WD.R) - zyzFromRotation(kinematics.X_WE.R);
  return J_A.transpose() * gains(kKp, kKpTurn).cwiseProduct(error);
}

TEST(OperationalPd, ReachesTheSetPoint) {
  for (const char* orientation : {"zyz", "rotation_vector"}) {
    ClosedLoop loop = pdLoop(JointVector::Zero(3), {{"orientation", orientation}});
    loop.run(12.0);  // the slowest pole is 200 / 150 = 1.33 1/s, along y: 1e-7 of the start is left
    EXPECT_LT((loop.q() - kTarget).norm(), 1e-6) << orientation;
    EXPECT_LT((loop.tip() - Vector3(0.5629, -0.66, 0.725)).norm(), 1e-4) << orientation;  // the report's four digits
  }
}

TEST(OperationalPd, WithoutGravityRestsWhereStiffnessCarriesGravity) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop = pdLoop(JointVector::Zero(3), {{"gravity", "none"}});
  loop.run(15.0);
  const JointVector g = gravityAt(robot, loop.q());
  EXPECT_LT((springEffort(loop.q()) - g).norm(), 1e-6);
  EXPECT_GT((loop.q() - kTarget).norm(), 0.01);
}

TEST(OperationalPd, WithFixedGravityRestsWhereStiffnessCarriesTheDifference) {
  const RobotModel robot = rppRobot();
  const JointVector zero = JointVector::Zero(3);
  ClosedLoop loop = pdLoop(zero, {{"gravity", "fixed"}});
  loop.run(15.0);
  EXPECT_LT((springEffort(loop.q()) - gravityAt(robot, loop.q()) + gravityAt(robot, zero)).norm(), 1e-6);
}

TEST(OperationalPd, ConvergesThroughTheZyzJump) {
  // q1 = 1.6 is beyond pi/2, where phi and psi jump by pi; q1 = pi/2 is where ZYZ angles do not exist.
  for (const double q1 : {1.6, kPi / 2}) {
    ClosedLoop loop = pdLoop(Vector3(q1, 0.0, 0.0));
    loop.run(15.0);
    EXPECT_LT((loop.q() - kTarget).norm(), 1e-6) << q1;
  }
}

TEST(OperationalPd, ZyzSticksBeyondTheJumpWithTheArmPulledThroughItself) {
  ClosedLoop loop = pdLoop(Vector3(2.0, 0.0, 0.0));
  loop.run(20.0);
  EXPECT_LT(loop.input.state.qd.norm(), 1e-6);
  EXPECT_LT(springEffort(loop.q()).norm(), 1e-4);  // an equilibrium
  const double L = 0.55 + loop.q()(2);
  EXPECT_LT(L, -0.5);
  EXPECT_GT((loop.tip() - tipPose(rppRobot(), kTarget).p).norm(), 0.05);  // and not the goal's
}

TEST(OperationalPd, RotationVectorConvergesFromWhereZyzSticks) {
  for (const double q1 : {-3.0, -2.0, 2.0, 2.6, 3.1}) {
    ClosedLoop loop = pdLoop(Vector3(q1, 0.0, 0.0), {{"orientation", "rotation_vector"}});
    loop.run(15.0);
    const Pose X_WD = tipPose(rppRobot(), kTarget);
    EXPECT_LT((loop.tip() - X_WD.p).norm(), 1e-6) << q1;
    EXPECT_LT((loop.input.state.X_WE.R - X_WD.R).norm(), 1e-6) << q1;
    EXPECT_GT(loop.q()(2), -0.55) << q1;  // L > 0
  }
}

LawInput randomInput(const RobotModel& robot, std::mt19937& generator) {
  const int n = robot.size();
  LawInput input;
  input.state = stateOf(robot, randomJointVector(generator, n, 1.0), randomJointVector(generator, n, 1.0));
  input.reference = setPoint(robot, randomJointVector(generator, n, 1.0));
  return input;
}

TEST(OperationalPd, EffortIsTheEquation) {
  const RobotModel robot = randomRevoluteChain(6, 111);
  const auto zyz = makeLaw("operational_pd", robot, {});
  const auto turned = makeLaw("operational_pd", robot, {{"orientation", "rotation_vector"}});
  std::mt19937 generator(112);
  int tested = 0;
  for (int i = 0; i < 100; ++i) {
    const LawInput input = randomInput(robot, generator);
    const Matrix3& R = input.state.X_WE.R;
    const Matrix3& R_d = input.reference.X_WE.R;
    Kinematics kinematics;
    computeKinematics(robot, input.state.q, input.state.qd, kinematics);
    const JointVector g = gravityAt(robot, input.state.q);
    JointVector tau;

    Vector6 error;
    const Eigen::AngleAxisd turn(R_d * R.transpose());
    error << input.reference.X_WE.p - input.state.X_WE.p, turn.angle() * turn.axis();
    Vector6 wrench = gains(kKp, kKpTurn).cwiseProduct(error) - gains(kKd, kKdTurn).cwiseProduct(input.state.V_WE);
    JointVector expected = g + kinematics.J.transpose() * wrench;
    ASSERT_EQ(turned->step(input, tau), LawStatus::kOk);
    EXPECT_LT((tau - expected).norm(), 1e-11 * (1.0 + expected.norm()));

    const Vector3 angles = zyzFromRotation(R);
    if (std::sin(angles(1)) < 0.1) continue;  // damped there
    ++tested;
    Jacobian J_A;
    ASSERT_TRUE(analyticalJacobian(kinematics, J_A));
    error.tail<3>() = zyzFromRotation(R_d) - angles;
    for (int k = 3; k < 6; ++k) {
      if (error(k) > kPi) error(k) -= 2 * kPi;
      if (error(k) < -kPi) error(k) += 2 * kPi;
    }
    const Vector6 rates = J_A * input.state.qd;
    wrench = gains(kKp, kKpTurn).cwiseProduct(error) - gains(kKd, kKdTurn).cwiseProduct(rates);
    expected = g + J_A.transpose() * wrench;
    ASSERT_EQ(zyz->step(input, tau), LawStatus::kOk);
    EXPECT_LT((tau - expected).norm(), 1e-10 * (1.0 + expected.norm()));  // rounding over sin(theta)^2
  }
  EXPECT_GT(tested, 80);
}

/// A spherical wrist whose joints are its ZYZ angles, with a hand 0.3 m long.
RobotModel wristRobot() {
  RobotModel robot = randomRevoluteChain(3, 113);
  robot.base = {};
  robot.joints[0].dh = {.a_m = 0.0, .alpha_rad = -kPi / 2, .theta_rad = 0.0, .d_m = 0.0};
  robot.joints[1].dh = {.a_m = 0.0, .alpha_rad = kPi / 2, .theta_rad = 0.0, .d_m = 0.0};
  robot.joints[2].dh = {.a_m = 0.0, .alpha_rad = 0.0, .theta_rad = 0.0, .d_m = 0.3};
  return robot;
}

TEST(OperationalPd, ZyzNeverRefusesAndStaysBoundedThroughTheSingularity) {
  const RobotModel robot = wristRobot();
  const auto law = makeLaw("operational_pd", robot, {});
  std::mt19937 generator(114);
  for (const double theta : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.03, 0.1, 0.2}) {
    for (int i = 0; i < 50; ++i) {
      LawInput input = randomInput(robot, generator);
      JointVector q = input.state.q;
      q(1) = i % 2 == 0 ? theta : kPi - theta;
      input.state = stateOf(robot, q, input.state.qd);
      ASSERT_NEAR(zyzFromRotation(input.state.X_WE.R)(1), q(1), 1e-8);
      JointVector tau;
      ASSERT_EQ(law->step(input, tau), LawStatus::kOk) << theta;
      // 12 per angle's rate, on 50 x pi of stiffness and 20 x 12 of damping for each of two angles.
      EXPECT_LT(tau.cwiseAbs().maxCoeff(), 2e4) << theta;
    }
  }
}

TEST(OperationalPd, LosesEnergyAtTheRateOfItsDamping) {
  // V = kinetic energy + x~^T Kp x~ / 2 falls at qd^T J^T Kd J qd: with equal gains for every turn, the rotation vector
  // is the gradient of its own square.
  const RobotModel robot = rppRobot();
  const Pose X_WD = tipPose(robot, kTarget);
  const auto imbalance = [&](double dt_s) {
    ClosedLoop loop(robot, makeLaw("operational_pd", robot, {{"orientation", "rotation_vector"}}), dt_s,
                    Vector3(2.0, 0.0, 0.0), [&](double) { return setPoint(robot, kTarget); });
    const auto energy = [&] {
      const Vector3 turn = rotationVector(X_WD.R * loop.input.state.X_WE.R.transpose());
      return kineticEnergy(robot, loop.q(), loop.input.state.qd) +
             0.5 * (kKp * (X_WD.p - loop.tip()).squaredNorm() + kKpTurn * turn.squaredNorm());
    };
    const auto power = [&] {
      const Vector6& V = loop.input.state.V_WE;
      return kKd * V.head<3>().squaredNorm() + kKdTurn * V.tail<3>().squaredNorm();
    };
    const double start = energy();
    double dissipated = 0.0;
    while (loop.time_s < 1.0) {
      const double before = power();
      EXPECT_TRUE(loop.step());
      dissipated += 0.5 * dt_s * (before + power());
    }
    return std::abs(energy() + dissipated - start) / start;
  };
  // The torque is held for a step, so the balance closes to first order in the step.
  const double one = imbalance(4e-5), half = imbalance(2e-5);
  EXPECT_LT(half, 5e-3);
  EXPECT_NEAR(one / half, 2.0, 0.3);
}

}  // namespace
}  // namespace baton
