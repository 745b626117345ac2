// Poles of the arm with friction and a touched wall, against closed forms and against the integration itself.
#include "robot/substeps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "robot/simulation.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using test::randomChain;
using test::slider;

StiffTerms terms(int n, double joint_damping, double stiffness, double tip_damping = 0.0) {
  StiffTerms terms{.joint_damping = JointVector::Constant(n, joint_damping)};
  terms.tip_stiffness = stiffness * Matrix3::Identity();
  terms.tip_damping = tip_damping * Matrix3::Identity();
  return terms;
}

SubstepNeed sliderNeed(double damping, double stiffness) {
  return substepNeed(slider(2.0), JointVector::Zero(1), terms(1, damping, stiffness));
}

TEST(SubstepNeed, OfAMassAreItsClosedForms) {
  const SubstepNeed damped = sliderNeed(4000.0, 0.0);
  EXPECT_NEAR(damped.pole_per_s, 2000.0, 1e-6);
  EXPECT_NEAR(damped.longest_s, 2.785 / 2000.0, 1e-3 / 2000.0);
  const SubstepNeed sprung = sliderNeed(0.0, 2e8);
  EXPECT_NEAR(sprung.pole_per_s, 1e4, 1e-3);
  EXPECT_NEAR(sprung.longest_s, std::sqrt(8.0) / 1e4, 1e-3 / 1e4);
  // A spring with dampers at joint and tip: m s^2 + (d + c) s + k.
  const SubstepNeed both = substepNeed(slider(2.0), JointVector::Zero(1), terms(1, 3e4, 1e8, 5e4));
  EXPECT_NEAR(both.pole_per_s, (8e4 + std::sqrt(64e8 - 8e8)) / 4.0, 1e-3);
}

TEST(SubstepNeed, IsNoneWithoutAPole) {
  const SubstepNeed none = sliderNeed(0.0, 0.0);
  EXPECT_EQ(none.longest_s, std::numeric_limits<double>::infinity());
  EXPECT_EQ(none.substeps(1.0), 1.0);
}

TEST(SubstepNeed, CountsWholeSubsteps) {
  const SubstepNeed need{.pole_per_s = 1.0, .longest_s = 0.25};
  EXPECT_EQ(need.substeps(0.1), 1.0);
  EXPECT_EQ(need.substeps(1.0), 4.0);
  EXPECT_EQ(need.substeps(1.1), 5.0);
}

/// How far the arm is from its place after many sub-steps, held by a spring at the tip and without gravity.
double wandering(const RobotModel& model, const JointVector& q0, double stiffness, double substep_s) {
  JointVector q = q0, qd = JointVector::Constant(model.size(), 1e-9);
  Contact contact;
  contact.df_dp = stiffness * Matrix3::Identity();
  const JointVector tau = JointVector::Zero(model.size());
  const bool is_finite = integrateStep(model, tau, contact, 2000 * substep_s, 2000, q, qd);
  return is_finite ? (q - q0).norm() : std::numeric_limits<double>::infinity();
}

TEST(SubstepNeed, DividesWhatTheIntegrationStandsFromWhatItDoesNot) {
  std::mt19937 random(3);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    RobotModel model = randomChain(3, seed);
    model.gravity_W.setZero();
    const JointVector q = test::randomJointVector(random, 3, 1.0);
    constexpr double kStiffness = 1e9;
    const SubstepNeed need = substepNeed(model, q, terms(3, 0.0, kStiffness));
    EXPECT_LT(wandering(model, q, kStiffness, 0.97 * need.longest_s), 1e-6) << seed;
    EXPECT_GT(wandering(model, q, kStiffness, 1.03 * need.longest_s), 1e-2) << seed;
  }
}

}  // namespace
}  // namespace baton
