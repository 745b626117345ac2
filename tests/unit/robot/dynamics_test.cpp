#include "robot/dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "robot/kinematics.hpp"
#include "support/robots.hpp"
#include "support/rpp_closed_form.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kPrinted = 5e-5;     // half a unit of the report's last digit
constexpr double kRounding = 1e-11;   // relative: a few hundred operations on numbers of mixed size
constexpr double kStep = 1e-5;        // of a central difference
constexpr double kDifference = 1e-7;  // relative: what such a difference leaves

const Vector3 kReportQ(kPi / 3, 0.1, 0.1);

struct State {
  JointVector q, qd, qdd;
  Vector6 h_e;
};

State randomState(std::mt19937& generator, int n) {
  State state;
  state.q = test::randomJointVector(generator, n, 3.0);
  state.qd = test::randomJointVector(generator, n, 2.0);
  state.qdd = test::randomJointVector(generator, n, 5.0);
  state.h_e = test::randomJointVector(generator, 6, 20.0);
  return state;
}

/// Calls check(model, state) for many states of chains of 1 to 8 joints.
template <typename Check>
void forManyChains(Check check) {
  std::mt19937 generator(7);
  for (int n = 1; n <= kMaxJoints; ++n) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const RobotModel model = test::randomChain(n, 100 * n + seed);
      for (int k = 0; k < 10; ++k) check(model, randomState(generator, n));
    }
  }
}

template <typename A, typename B>
void expectClose(const A& actual, const B& expected, double relative) {
  EXPECT_LT((actual - expected).norm(), relative * (1.0 + expected.norm())) << actual << "\nexpected\n" << expected;
}

JointMatrix massMatrixAt(const RobotModel& model, const JointVector& q) {
  JointMatrix B;
  massMatrix(model, q, B);
  return B;
}

LagrangeTerms lagrangeAt(const RobotModel& model, const JointVector& q, const JointVector& qd) {
  LagrangeTerms terms;
  lagrangeDynamics(model, q, qd, terms);
  return terms;
}

TEST(RppDynamics, GiveTheDigitsOfTheReport) {
  const RobotModel robot = test::rppRobot();
  const JointVector at_rest = JointVector::Zero(3);
  const Vector3 printed_g(2.3767, 0.0, 0.3439);
  const Matrix3 printed_B = Vector3(0.3425, 1.1583, 0.0405).asDiagonal();

  JointVector g, tau;
  gravityEffort(robot, kReportQ, g);
  EXPECT_LT((g - printed_g).cwiseAbs().maxCoeff(), kPrinted);
  EXPECT_LT((massMatrixAt(robot, kReportQ) - printed_B).cwiseAbs().maxCoeff(), kPrinted);
  inverseDynamics(robot, kReportQ, at_rest, at_rest, Vector6::Zero(), tau);
  EXPECT_LT((tau - printed_g).cwiseAbs().maxCoeff(), kPrinted);

  const LagrangeTerms lagrange = lagrangeAt(robot, kReportQ, at_rest);
  EXPECT_LT((lagrange.g - printed_g).cwiseAbs().maxCoeff(), kPrinted);
  EXPECT_LT((lagrange.B - printed_B).cwiseAbs().maxCoeff(), kPrinted);
}

TEST(RppDynamics, AreTheirClosedForms) {
  const RobotModel robot = test::rppRobot();
  std::mt19937 generator(1);
  for (int k = 0; k < 200; ++k) {
    const State state = randomState(generator, 3);
    const Matrix3 B = test::rpp::massMatrix(state.q), C = test::rpp::coriolisMatrix(state.q, state.qd);
    const Vector3 g = test::rpp::gravityEffort(state.q);
    expectClose(massMatrixAt(robot, state.q), B, kRounding);
    const LagrangeTerms lagrange = lagrangeAt(robot, state.q, state.qd);
    expectClose(lagrange.C, C, kRounding);
    expectClose(lagrange.g, g, kRounding);
    JointVector n;
    biasEffort(robot, state.q, state.qd, n);
    expectClose(n, C * state.qd + g, kRounding);
  }
}

TEST(RppDynamics, TakeTheTipsForceAtTheJointsWithTheSignOfTheEnvironment) {
  // Pressing up with 3 N at q1 = 0: joint 1 must push up through the reach L, against an arm that weighs down.
  const RobotModel robot = test::rppRobot();
  const JointVector zero = JointVector::Zero(3);
  JointVector free, pressing;
  inverseDynamics(robot, zero, zero, zero, Vector6::Zero(), free);
  Vector6 h_e = Vector6::Zero();
  h_e(2) = 3.0;
  inverseDynamics(robot, zero, zero, zero, h_e, pressing);
  EXPECT_LT((pressing - free - Vector3(3.0 * 0.55, 0.0, 0.0)).norm(), 1e-14);
}

TEST(Link1Dynamics, AreItsEquation) {
  const RobotModel robot = test::link1Robot();
  const double moment = 1.1 * 1.1 * 3.5 * 2.7 * 9.806 * 1.75;
  std::mt19937 generator(2);
  for (int k = 0; k < 50; ++k) {
    const State state = randomState(generator, 1);
    JointVector tau, friction;
    inverseDynamics(robot, state.q, state.qd, state.qdd, Vector6::Zero(), tau);
    frictionEffort(robot, state.qd, friction);
    const double expected = 0.1 * state.qdd(0) + 0.2 * state.qd(0) + moment * std::sin(state.q(0));
    EXPECT_NEAR(tau(0) + friction(0), expected, 1e-11);
  }
  JointVector g;
  gravityEffort(robot, JointVector::Zero(1), g);
  EXPECT_EQ(g(0), 0.0);
}

TEST(BothRoads, AgreeTermByTerm) {
  forManyChains([](const RobotModel& model, const State& state) {
    const LagrangeTerms lagrange = lagrangeAt(model, state.q, state.qd);
    JointVector n, g;
    biasEffort(model, state.q, state.qd, n);
    gravityEffort(model, state.q, g);
    expectClose(massMatrixAt(model, state.q), lagrange.B, kRounding);
    expectClose(n, lagrange.C * state.qd + lagrange.g, kRounding);
    expectClose(g, lagrange.g, kRounding);
  });
}

TEST(BothRoads, AgreeOnTheWholeEquation) {
  forManyChains([](const RobotModel& model, const State& state) {
    const LagrangeTerms lagrange = lagrangeAt(model, state.q, state.qd);
    Kinematics kinematics;
    computeKinematics(model, state.q, state.qd, kinematics);
    JointVector tau;
    inverseDynamics(model, state.q, state.qd, state.qdd, state.h_e, tau);
    const JointVector expected =
        lagrange.B * state.qdd + lagrange.C * state.qd + lagrange.g + kinematics.J.transpose() * state.h_e;
    expectClose(tau, expected, kRounding);
  });
}

TEST(MassMatrix, IsSymmetricAndPositiveDefinite) {
  forManyChains([](const RobotModel& model, const State& state) {
    const JointMatrix B = massMatrixAt(model, state.q);
    EXPECT_EQ(B, B.transpose());
    EXPECT_GT(Eigen::MatrixXd(B).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
  });
}

TEST(MassMatrix, GivesTheKineticEnergy) {
  forManyChains([](const RobotModel& model, const State& state) {
    const double expected = 0.5 * state.qd.dot(massMatrixAt(model, state.q) * state.qd);
    EXPECT_NEAR(kineticEnergy(model, state.q, state.qd), expected, kRounding * (1.0 + expected));
  });
}

TEST(CoriolisMatrix, MakesBdotMinus2CSkewSymmetric) {
  forManyChains([](const RobotModel& model, const State& state) {
    const JointMatrix after = massMatrixAt(model, state.q + kStep * state.qd);
    const JointMatrix before = massMatrixAt(model, state.q - kStep * state.qd);
    const JointMatrix B_dot = (after - before) / (2 * kStep);
    const JointMatrix C = lagrangeAt(model, state.q, state.qd).C;
    const JointMatrix N = B_dot - 2.0 * C;
    EXPECT_LT((N + N.transpose()).norm(), kDifference * (1.0 + B_dot.norm()));
  });
}

TEST(GravityEffort, IsTheGradientOfThePotentialEnergy) {
  forManyChains([](const RobotModel& model, const State& state) {
    JointVector g, gradient(model.size());
    gravityEffort(model, state.q, g);
    for (int i = 0; i < model.size(); ++i) {
      const JointVector h = kStep * JointVector::Unit(model.size(), i);
      gradient(i) = (potentialEnergy(model, state.q + h) - potentialEnergy(model, state.q - h)) / (2 * kStep);
    }
    expectClose(g, gradient, kDifference);
  });
}

TEST(Friction, IsViscousPlusSmoothCoulombAndOpposesMotion) {
  RobotModel robot = test::rppRobot();
  robot.joints[0].friction = {.viscous = 2.0, .coulomb = 0.0, .coulomb_velocity = 1e-3};
  robot.joints[1].friction = {.viscous = 0.0, .coulomb = 3.0, .coulomb_velocity = 0.1};
  JointVector tau_f;
  frictionEffort(robot, Vector3(-0.5, 0.1, 4.0), tau_f);
  EXPECT_LT((tau_f - Vector3(-1.0, 3.0 * std::tanh(1.0), 0.0)).norm(), 1e-15);
  frictionEffort(robot, Vector3(0.0, -10.0, 0.0), tau_f);  // far above coulomb_velocity: its sign
  EXPECT_LT((tau_f - Vector3(0.0, -3.0, 0.0)).norm(), 1e-15);
}

TEST(ForwardDynamics, UndoInverseDynamicsWithFrictionAndContact) {
  forManyChains([](RobotModel model, const State& state) {
    model.joints[0].friction = {.viscous = 0.7, .coulomb = 1.5, .coulomb_velocity = 0.05};
    JointVector tau, friction, qdd;
    inverseDynamics(model, state.q, state.qd, state.qdd, state.h_e, tau);
    frictionEffort(model, state.qd, friction);
    tau += friction;
    ASSERT_TRUE(forwardDynamics(model, state.q, state.qd, tau, state.h_e, qdd));
    // B^-1 enlarges the rounding of tau; 1e4 is above the condition number of these chains.
    expectClose(qdd, state.qdd, 1e4 * kRounding);
  });
}

TEST(ForwardDynamics, RefuseWhatHasNoAnswerAndLeaveTheResultAlone) {
  RobotModel robot = test::rppRobot();
  const JointVector zero = JointVector::Zero(3);
  JointVector qdd = JointVector::Constant(3, 7.0);
  const JointVector no_number = JointVector::Constant(3, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(forwardDynamics(robot, zero, zero, no_number, Vector6::Zero(), qdd));
  EXPECT_FALSE(forwardDynamics(robot, no_number, zero, zero, Vector6::Zero(), qdd));
  robot.joints[2].link = LinkInertia{};  // B33 = 0
  EXPECT_FALSE(forwardDynamics(robot, zero, zero, zero, Vector6::Zero(), qdd));
  EXPECT_EQ(qdd, JointVector::Constant(3, 7.0));
}

}  // namespace
}  // namespace baton
