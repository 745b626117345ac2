#include "robot/regressor.hpp"

#include <gtest/gtest.h>

#include <random>

#include "robot/dynamics.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kRounding = 1e-11;  // relative: a few hundred operations on numbers of mixed size

struct Motion {
  JointVector q, qd, v, a;
};

Motion randomMotion(std::mt19937& generator, int n) {
  Motion motion;
  motion.q = test::randomJointVector(generator, n, 3.0);
  motion.qd = test::randomJointVector(generator, n, 2.0);
  motion.v = test::randomJointVector(generator, n, 2.0);
  motion.a = test::randomJointVector(generator, n, 5.0);
  return motion;
}

/// Calls check(model, motion) for many motions of chains of 1 to 8 joints, each with friction.
template <typename Check>
void forManyChains(Check check) {
  std::mt19937 generator(21);
  for (int n = 1; n <= kMaxJoints; ++n) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      RobotModel model = test::randomChain(n, 100 * n + seed);
      for (Joint& joint : model.joints) joint.friction.viscous = test::uniform(generator, 0.0, 2.0);
      for (int k = 0; k < 10; ++k) check(model, randomMotion(generator, n));
    }
  }
}

void expectClose(const JointVector& actual, const JointVector& expected) {
  EXPECT_LT((actual - expected).norm(), kRounding * (1.0 + expected.norm()));
}

JointVector viscousFriction(const RobotModel& model, const JointVector& v) {
  JointVector friction(model.size());
  for (int i = 0; i < model.size(); ++i) friction(i) = model.joints[i].friction.viscous * v(i);
  return friction;
}

JointVector effortByRegressor(const RobotModel& model, const Motion& motion) {
  Regressor Y;
  dynamicsRegressor(model, motion.q, motion.qd, motion.v, motion.a, Y);
  return Y * dynamicParameters(model);
}

TEST(Regressor, IsInverseDynamicsAtTheActualVelocity) {
  forManyChains([](const RobotModel& model, Motion motion) {
    motion.v = motion.qd;
    JointVector tau;
    inverseDynamics(model, motion.q, motion.qd, motion.a, Vector6::Zero(), tau);
    expectClose(effortByRegressor(model, motion), tau + viscousFriction(model, motion.qd));
  });
}

TEST(Regressor, IsLagrangesTermsWithChristoffelsMatrixAtAnyOtherVelocity) {
  forManyChains([](const RobotModel& model, const Motion& motion) {
    LagrangeTerms terms;
    lagrangeDynamics(model, motion.q, motion.qd, terms);
    const JointVector expected = terms.B * motion.a + terms.C * motion.v + terms.g + viscousFriction(model, motion.v);
    expectClose(effortByRegressor(model, motion), expected);
  });
}

TEST(Regressor, IsBlindToTheParametersItMultiplies) {
  forManyChains([](const RobotModel& model, const Motion& motion) {
    RobotModel other = model;
    for (Joint& joint : other.joints) joint.link = {}, joint.friction = {};
    Regressor Y, Y_other;
    dynamicsRegressor(model, motion.q, motion.qd, motion.v, motion.a, Y);
    dynamicsRegressor(other, motion.q, motion.qd, motion.v, motion.a, Y_other);
    EXPECT_EQ(Y, Y_other);
  });
}

TEST(Regressor, EachColumnIsTheEffortOfItsParameterAlone) {
  // One parameter set to 1 and all others to 0: not a body, but the recursion does not mind.
  std::mt19937 generator(22);
  RobotModel model = test::randomChain(3, 23);
  const Motion motion = randomMotion(generator, 3);
  Regressor Y;
  dynamicsRegressor(model, motion.q, motion.qd, motion.qd, motion.a, Y);
  for (Joint& joint : model.joints) joint.link = {};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < kParametersPerJoint - 1; ++k) {
      RobotModel single = model;
      LinkInertia& link = single.joints[i].link;
      if (k == 0) link.mass_kg = 1.0;
      if (k >= 1 && k <= 3) link.first_moment_kg_m(k - 1) = 1.0;
      constexpr int kRow[] = {0, 0, 0, 1, 1, 2}, kColumn[] = {0, 1, 2, 1, 2, 2};
      if (k >= 4) {
        link.inertia_origin_kg_m2(kRow[k - 4], kColumn[k - 4]) = 1.0;
        link.inertia_origin_kg_m2(kColumn[k - 4], kRow[k - 4]) = 1.0;
      }
      JointVector tau;
      inverseDynamics(single, motion.q, motion.qd, motion.a, Vector6::Zero(), tau);
      expectClose(Y.col(i * kParametersPerJoint + k), tau);
    }
  }
}

TEST(Regressor, OfTheReportsLinkIsItsThreeTerms) {
  const RobotModel link = test::link1Robot();
  std::mt19937 generator(24);
  for (int k = 0; k < 20; ++k) {
    const Motion motion = randomMotion(generator, 1);
    Regressor Y;
    dynamicsRegressor(link, motion.q, motion.qd, motion.v, motion.a, Y);
    // First moment along the link times g sin(q), inertia about the joint times a, friction times v.
    EXPECT_NEAR(Y(0, 1), 9.806 * std::sin(motion.q(0)), 1e-14);
    EXPECT_EQ(Y(0, 9), motion.a(0));
    EXPECT_EQ(Y(0, 10), motion.v(0));
  }
}

}  // namespace
}  // namespace baton
