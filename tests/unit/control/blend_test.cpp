#include "control/blend.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

const JointVector kR0 = Vector3(10.0, -4.0, 0.5);

JointVector added(const BumplessBlend& blend, std::uint64_t step) {
  JointVector tau = JointVector::Zero(3);
  blend.add(step, tau);
  return tau;
}

TEST(QuinticFade, GoesFromOneToZeroWithoutSlopeOrCurvatureAtItsEnds) {
  EXPECT_EQ(quinticFade(0.0), 1.0);
  EXPECT_EQ(quinticFade(1.0), 0.0);
  EXPECT_EQ(quinticFade(0.5), 0.5);
  // A cubic start: 1 - sigma(h) = 10 h^3 + O(h^4), so value, slope and curvature all vanish there; the same at the end.
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    EXPECT_NEAR(1.0 - quinticFade(h), 10.0 * h * h * h, 20.0 * h * h * h * h + 1e-15);
    EXPECT_NEAR(quinticFade(1.0 - h), 10.0 * h * h * h, 20.0 * h * h * h * h + 1e-15);
  }
}

TEST(QuinticFade, FallsMonotonicallyAndSymmetrically) {
  for (double s = 0.0; s < 0.999; s += 0.001) {
    EXPECT_GE(quinticFade(s), quinticFade(s + 0.001));
    EXPECT_NEAR(quinticFade(s) + quinticFade(1.0 - s), 1.0, 1e-14);
  }
  EXPECT_EQ(quinticFade(-1.0), 1.0);
  EXPECT_EQ(quinticFade(2.0), 0.0);
}

TEST(BumplessBlend, StartsWithTheWholeRemainderAndEndsWithNone) {
  BumplessBlend blend;
  EXPECT_TRUE(added(blend, 0).isZero(0.0));
  blend.start(1000, 200, kR0);
  EXPECT_TRUE(added(blend, 999).isZero(0.0));
  EXPECT_EQ(added(blend, 1000), kR0);  // tau_new + r0 = tau_old, exactly
  EXPECT_LT((added(blend, 1100) - kR0 / 2).norm(), 1e-15);
  EXPECT_TRUE(blend.isActive(1199));
  EXPECT_LT(added(blend, 1199).norm(), 2e-6 * kR0.norm());
  EXPECT_FALSE(blend.isActive(1200));
  EXPECT_TRUE(added(blend, 1200).isZero(0.0));
  EXPECT_TRUE(added(blend, 1000000).isZero(0.0));
}

TEST(BumplessBlend, NeverStepsFasterThanItsSteepestSlope) {
  BumplessBlend blend;
  blend.start(0, 100, kR0);
  for (std::uint64_t k = 0; k < 120; ++k) {
    EXPECT_LE((added(blend, k + 1) - added(blend, k)).norm(), 1.875 / 100 * kR0.norm());  // max |sigma'| = 15/8
  }
}

TEST(BumplessBlend, WithoutDurationAddsNothing) {
  BumplessBlend blend;
  blend.start(5, 0, kR0);
  EXPECT_TRUE(added(blend, 5).isZero(0.0));
}

TEST(BumplessBlend, ASecondSwapReplacesWhatIsLeftOfTheFirst) {
  // Old law 1, then law 2 at step 0, law 3 at step 40 while the first fade runs: the applied effort does not jump.
  const JointVector tau1 = Vector3(1, 2, 3), tau2 = Vector3(-5, 0, 4), tau3 = Vector3(9, 9, 9);
  BumplessBlend blend;
  blend.start(0, 100, tau1 - tau2);
  JointVector applied = tau2;
  blend.add(40, applied);
  blend.start(40, 100, applied - tau3);
  JointVector after = tau3;
  blend.add(40, after);
  EXPECT_LT((after - applied).norm(), 1e-14);
}

}  // namespace
}  // namespace baton
