#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "control/task_space.hpp"
#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

const Vector3 kKp(280.0, 280.0, 70.0), kKd(30.0, 30.0, 20.0);  // the report's gains and the law's defaults
constexpr double kStep = 5e-4;                                 // s
const JointVector kTarget = Vector3(kPi / 6, 0.2, 0.1);

/// Tip acceleration that the arm, not the law's model of it, makes of an effort.
Vector6 tipAcceleration(const RobotModel& robot, const RobotState& state, const JointVector& tau) {
  JointVector qdd;
  EXPECT_TRUE(forwardDynamics(robot, state.q, state.qd, tau, Vector6::Zero(), qdd));
  Kinematics kinematics;
  computeKinematics(robot, state.q, state.qd, kinematics);
  return kinematics.J * qdd + kinematics.Jdot_qd;
}

TEST(OperationalInverseDynamics, MakesTheTipAccelerateAsTheErrorDynamicsAsk) {
  for (const int n : {3, 4, 7}) {
    const RobotModel robot = n == 3 ? rppRobot() : randomRevoluteChain(n, 60 + n);
    const auto law = makeLaw("operational_inverse_dynamics", robot, {});
    std::mt19937 generator(n);
    int solved = 0;
    for (int i = 0; i < 50; ++i) {
      LawInput input;
      input.state = stateOf(robot, randomJointVector(generator, n, 0.4), randomJointVector(generator, n, 1.0));
      input.reference = sineReference(robot, i);
      JointVector tau;
      if (law->step(input, tau) != LawStatus::kOk) continue;
      ++solved;
      const Vector3 x_error = input.reference.X_WE.p - input.state.X_WE.p;
      const Vector3 xd_error = (input.reference.V_WE - input.state.V_WE).head<3>();
      const Vector3 a = input.reference.A_WE.head<3>() + kKd.cwiseProduct(xd_error) + kKp.cwiseProduct(x_error);
      // Rounding, times the condition of B, times that of J_P squared.
      EXPECT_LT((tipAcceleration(robot, input.state, tau).head<3>() - a).norm(), 1e-8 * (1.0 + a.norm())) << n;
    }
    EXPECT_GE(solved, 45) << n;
  }
}

TEST(OperationalInverseDynamics, PseudoInverseServesAllSixCoordinatesOfALongArm) {
  for (const int n : {6, 7, 8}) {
    const RobotModel robot = randomRevoluteChain(n, 70 + n);
    const auto law =
        makeLaw("operational_inverse_dynamics", robot,
                {{"solver", "pseudo_inverse"}, {"kp", std::vector<double>{100.0}}, {"kd", std::vector<double>{20.0}}});
    std::mt19937 generator(n);
    int solved = 0;
    for (int i = 0; i < 50; ++i) {
      LawInput input;
      input.state = stateOf(robot, randomJointVector(generator, n, 1.0), randomJointVector(generator, n, 1.0));
      input.reference = sineReference(robot, i);
      JointVector tau;
      if (law->step(input, tau) != LawStatus::kOk) continue;
      ++solved;
      Vector6 x_error;
      const Eigen::AngleAxisd turn(input.reference.X_WE.R * input.state.X_WE.R.transpose());
      x_error << input.reference.X_WE.p - input.state.X_WE.p, turn.angle() * turn.axis();
      const Vector6 a = input.reference.A_WE + 20.0 * (input.reference.V_WE - input.state.V_WE) + 100.0 * x_error;
      EXPECT_LT((tipAcceleration(robot, input.state, tau) - a).norm(), 1e-7 * (1.0 + a.norm())) << n;
    }
    EXPECT_GE(solved, 40) << n;
  }
}

TEST(OperationalInverseDynamics, EverySolverReachesTheSetPointOfTheReportsArm) {
  const RobotModel robot = rppRobot();
  for (const char* solver : {"position", "pseudo_inverse", "damped_least_squares"}) {
    ClosedLoop loop(robot, makeLaw("operational_inverse_dynamics", robot, {{"solver", solver}}), kStep,
                    JointVector::Zero(3), [&](double) { return setPoint(robot, kTarget); });
    loop.run(15.0);  // the slowest pole, in z, is 4.5 1/s; least squares over six coordinates is slower
    EXPECT_LT((loop.tip() - Vector3(0.5629, -0.66, 0.725)).norm(), 1e-4) << solver;  // the report's four digits
    EXPECT_LT((loop.q() - kTarget).norm(), 1e-6) << solver;
  }
}

TEST(OperationalInverseDynamics, CrossesTheZyzJumpUnharmed) {
  // The ZYZ angles jump at q1 = pi/2; the position Jacobian and the rotation vector know nothing of it.
  const RobotModel robot = rppRobot();
  const JointVector beyond = Vector3(2.2, 0.1, 0.1);
  for (const char* solver : {"position", "pseudo_inverse"}) {
    ClosedLoop loop(robot, makeLaw("operational_inverse_dynamics", robot, {{"solver", solver}}), kStep,
                    Vector3(1.2, 0.1, 0.1), [&](double) { return setPoint(robot, beyond); });
    loop.run(15.0);
    EXPECT_LT((loop.q() - beyond).norm(), 1e-6) << solver;
  }
}

TEST(OperationalInverseDynamics, WrongModelsRestWhereTheoryPutsThem) {
  const RobotModel robot = rppRobot();
  struct Case {
    const char* name;
    ParameterValues parameters;
    std::function<JointVector(const JointVector& q, const JointVector& y)> imbalance;  // zero at rest
  };
  // y = J_P^-1 Kp x~ at rest, and the law's effort must carry gravity.
  const std::vector<Case> cases = {
      {"mass_scale",
       {{"mass_scale", std::vector<double>{1.2}}},
       [&](const JointVector& q, const JointVector& y) -> JointVector {
         return 1.2 * massMatrixAt(robot, q) * y + 0.2 * gravityAt(robot, q);
       }},
      {"ignore_inertia",
       {{"model", "ignore_inertia"}},
       [&](const JointVector&, const JointVector& y) -> JointVector { return y; }},
      {"ignore_bias",
       {{"model", "ignore_bias"}},
       [&](const JointVector& q, const JointVector& y) -> JointVector {
         return massMatrixAt(robot, q) * y - gravityAt(robot, q);
       }},
      {"ignore_both",
       {{"model", "ignore_both"}},
       [&](const JointVector& q, const JointVector& y) -> JointVector { return y - gravityAt(robot, q); }},
  };
  for (const Case& c : cases) {
    ClosedLoop loop(robot, makeLaw("operational_inverse_dynamics", robot, c.parameters), kStep, JointVector::Zero(3),
                    [&](double) { return setPoint(robot, kTarget); });
    loop.run(15.0);
    Kinematics kinematics;
    computeKinematics(robot, loop.q(), JointVector::Zero(3), kinematics);
    const Vector3 x_error = tipPose(robot, kTarget).p - loop.tip();
    const Matrix3 J_P = kinematics.J.topRows<3>();
    const JointVector y = J_P.inverse() * kKp.cwiseProduct(x_error);
    EXPECT_LT(c.imbalance(loop.q(), y).norm(), 1e-8) << c.name;
  }
}

TEST(OperationalInverseDynamics, NullSpaceMotionDiesAway) {
  // A long arm holding its tip still: joint motion that the tip does not feel must stop, not coast.
  const RobotModel robot = randomRevoluteChain(7, 77);
  std::mt19937 generator(78);
  const JointVector q0 = randomJointVector(generator, 7, 1.0);
  ClosedLoop loop(robot, makeLaw("operational_inverse_dynamics", robot, {}), kStep, q0,
                  [&](double) { return setPoint(robot, q0); });
  Kinematics kinematics;
  computeKinematics(robot, q0, JointVector::Zero(7), kinematics);
  const Eigen::MatrixXd J_P = kinematics.J.topRows<3>();
  const Eigen::MatrixXd projector =
      Eigen::MatrixXd::Identity(7, 7) - J_P.transpose() * (J_P * J_P.transpose()).inverse() * J_P;
  const JointVector unfelt = projector * randomJointVector(generator, 7, 0.3);
  ASSERT_GT(unfelt.norm(), 0.05);
  loop.input.state.qd = unfelt;
  loop.run(4.0);
  EXPECT_LT(loop.input.state.qd.norm(), 1e-6);
  EXPECT_LT((loop.tip() - tipPose(robot, q0).p).norm(), 1e-6);
}

TEST(OperationalInverseDynamics, SaysWhenItIsSingular) {
  const RobotModel robot = rppRobot();
  const auto law = makeLaw("operational_inverse_dynamics", robot, {});
  LawInput input;
  input.state = stateOf(robot, Vector3(0.4, 0.1, -0.55), JointVector::Zero(3));
  input.reference = setPoint(robot, kTarget);
  const JointVector marker = Vector3(1.0, 2.0, 3.0);
  JointVector tau = marker;
  EXPECT_EQ(law->step(input, tau), LawStatus::kSingular);
  EXPECT_EQ(tau, marker);
}

}  // namespace
}  // namespace baton
