#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "derivatives.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using test::expectDerivatives;
using test::referenceAt;

constexpr double kPi = 3.14159265358979323846;

/// The report's q_d = (pi/3) sin t of the single link.
JointSine reportSine() {
  const auto one = [](double x) { return JointVector(JointVector::Constant(1, x)); };
  return {.offset = one(0.0), .amplitude = one(kPi / 3), .frequency_rad_per_s = one(1.0), .phase_rad = one(0.0)};
}

JointSine threeSines() {
  return {.offset = Vector3(0.2, 0.1, 0.1),
          .amplitude = Vector3(0.5, 0.05, 0.0),
          .frequency_rad_per_s = Vector3(2.0, 3.0, 1.0),
          .phase_rad = Vector3(0.0, kPi / 2, 1.0)};
}

TEST(JointSine, IsTheSineAndItsDerivatives) {
  const Trajectory trajectory(test::link1Robot(), {.motion = reportSine()});
  for (double t = 0.0; t < 20.0; t += 0.1) {
    const Reference reference = referenceAt(trajectory, t);
    EXPECT_NEAR(reference.q(0), kPi / 3 * std::sin(t), 1e-15) << t;
    EXPECT_NEAR(reference.qd(0), kPi / 3 * std::cos(t), 1e-15) << t;
    EXPECT_NEAR(reference.qdd(0), -kPi / 3 * std::sin(t), 1e-15) << t;
  }
  EXPECT_EQ(trajectory.endTime(), std::numeric_limits<double>::infinity());
}

TEST(JointSine, GivesEachJointItsOwn) {
  const Trajectory trajectory(test::rppRobot(), {.motion = threeSines()});
  for (const double t : {0.0, 0.7, 5.3}) {
    const JointVector q = referenceAt(trajectory, t).q;
    EXPECT_NEAR(q(0), 0.2 + 0.5 * std::sin(2.0 * t), 1e-15);
    EXPECT_NEAR(q(1), 0.1 + 0.05 * std::cos(3.0 * t), 1e-15);
    EXPECT_EQ(q(2), 0.1);
  }
  for (double t = 0.0; t < 5.0; t += 0.037) expectDerivatives(trajectory, t);
}

TEST(JointSine, ComesToRestAtItsEndOnTheCurveItWasOn) {
  JointSine sine = threeSines();
  const Trajectory endless(test::rppRobot(), {.motion = sine});
  sine.end_s = 4.0;
  sine.slow_down_s = 1.5;
  const Trajectory trajectory(test::rppRobot(), {.motion = sine});
  EXPECT_EQ(trajectory.endTime(), 4.0);
  for (const double t : {0.0, 1.0, 2.5}) EXPECT_EQ(referenceAt(trajectory, t).q, referenceAt(endless, t).q) << t;

  // The sine's own time gains half of what it takes to slow down.
  const JointVector rest = referenceAt(endless, 4.0 - 0.75).q;
  for (const double t : {4.0, 4.1, 100.0}) {
    const Reference reference = referenceAt(trajectory, t);
    EXPECT_LT((reference.q - rest).norm(), 1e-15) << t;
    EXPECT_TRUE(reference.qd.isZero(0.0) && reference.qdd.isZero(0.0)) << t;
    EXPECT_TRUE(reference.V_WE.isZero(0.0) && reference.A_WE.isZero(0.0)) << t;
  }

  for (double t = 2.0; t < 4.5; t += 0.0137) expectDerivatives(trajectory, t, 5e-8);
  constexpr double kGap = 1e-9;  // slopes here are below 100
  for (const double t : {2.5, 4.0}) {
    const Reference before = referenceAt(trajectory, t - kGap), after = referenceAt(trajectory, t + kGap);
    EXPECT_LT((after.q - before.q).norm(), 1e-7) << t;
    EXPECT_LT((after.qd - before.qd).norm(), 1e-7) << t;
    EXPECT_LT((after.qdd - before.qdd).norm(), 1e-7) << t;
  }
}

TEST(JointSine, EvaluatesWithoutAllocating) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer has its own malloc";
  JointSine sine = threeSines();
  sine.end_s = 3.0;
  const Trajectory trajectory(test::rppRobot(), {.motion = sine});
  Reference reference;
  const test::AllocationGuard guard;
  for (double t = -1.0; t < 5.0; t += 0.01) trajectory.evaluate(t, reference);
  EXPECT_EQ(guard.count(), 0u);
}

}  // namespace
}  // namespace baton
