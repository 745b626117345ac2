#include "trajectory/hold_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "derivatives.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using test::referenceAt;

constexpr int kHolds = 100'000;
// An estimate from n samples scatters; five of its standard deviations are passed once in two million. The seeds are
// fixed, so a test that passes once passes always.
constexpr double kSigmas = 5.0;

std::vector<double> samples(std::uint64_t seed, int joint, int first_hold = 0) {
  std::vector<double> all;
  for (int k = first_hold; k < first_hold + kHolds; ++k) all.push_back(standardNormal(seed, k, joint));
  return all;
}

/// Mean of a product; 0 with a standard deviation of 1 / sqrt(n) for independent standard normal samples.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

TEST(StandardNormal, HasTheMomentsOfTheNormalDistribution) {
  // E x^k and the variance of x^k, which is E x^2k - (E x^k)^2: the even moments are 1, 3, 15, 105.
  struct Moment {
    int power;
    double expected, variance;
  };
  for (const std::uint64_t seed : {1u, 2u, 12345u}) {
    for (int joint = 0; joint < 3; ++joint) {
      const std::vector<double> all = samples(seed, joint);
      for (const Moment& moment : {Moment{1, 0, 1}, Moment{2, 1, 2}, Moment{3, 0, 15}, Moment{4, 3, 96}}) {
        double sum = 0.0;
        for (const double x : all) sum += std::pow(x, moment.power);
        EXPECT_NEAR(sum / kHolds, moment.expected, kSigmas * std::sqrt(moment.variance / kHolds)) << moment.power;
      }
    }
  }
}

TEST(StandardNormal, FallsIntoEachIntervalAsOftenAsTheNormalDistribution) {
  const std::vector<double> all = samples(3, 0);
  for (double x = -3.0; x <= 3.0; x += 0.5) {
    const double expected = 0.5 * std::erfc(-x / std::sqrt(2.0));  // the distribution function
    int below = 0;
    for (const double sample : all) below += sample < x ? 1 : 0;
    const double scatter = std::sqrt(expected * (1.0 - expected) / kHolds);
    EXPECT_NEAR(static_cast<double>(below) / kHolds, expected, kSigmas * scatter) << x;
  }
}

TEST(StandardNormal, IsIndependentBetweenJointsHoldsAndSeeds) {
  const double bound = kSigmas / std::sqrt(kHolds);
  const std::vector<double> all = samples(1, 0);
  EXPECT_LT(std::abs(correlation(all, samples(1, 1))), bound);
  EXPECT_LT(std::abs(correlation(all, samples(1, 7))), bound);
  EXPECT_LT(std::abs(correlation(all, samples(2, 0))), bound);
  EXPECT_LT(std::abs(correlation(all, samples(1, 0, 1))), bound);  // the next hold
  EXPECT_LT(std::abs(correlation(all, samples(1, 1, 1))), bound);
}

TEST(StandardNormal, IsTheSameToTheLastBitEverywhere) {
  // Computed by another program in another language from the description in the header. A recording made today must be
  // made again by every later version, on every machine.
  EXPECT_EQ(standardNormal(1, 0, 0), -0x1.49f82d3d1560fp+0);
  EXPECT_EQ(standardNormal(1, 0, 1), -0x1.2c2a0a42a02b2p-1);
  EXPECT_EQ(standardNormal(1, 1, 0), -0x1.34b51e1b80f57p-2);
  EXPECT_EQ(standardNormal(2, 0, 0), 0x1.9a1220d61f98dp-2);
  EXPECT_EQ(standardNormal(7, 599, 2), -0x1.10bd9b9c8b5eap+0);
  EXPECT_EQ(standardNormal(1, -1, 0), -0x1.a707b9889dbb6p-2);
}

TEST(HoldIndex, CountsHoldsThatAreNoBinaryFractions) {
  // 0.3 / 0.1 is below 3 in binary. Steps of 0.5 ms: every hold has its 200 steps.
  const HoldNoise noise{.hold_s = 0.1};
  for (std::int64_t step = 0; step < 20'000; ++step) {
    const double time_s = static_cast<double>(step * 500'000) * 1e-9;
    EXPECT_EQ(holdIndex(noise, time_s), step / 200) << step;
  }
  EXPECT_EQ(holdIndex(noise, -0.05), -1);
}

TrajectorySpec noisySetPoint(std::uint64_t seed) {
  return {.motion = JointPath{.waypoints = {{0.0, Vector3(0.5, 0.2, 0.1)}}},
          .noise = HoldNoise{.hold_s = 0.1, .standard_deviation = Vector3(0.1, 0.02, 0.02), .seed = seed}};
}

TEST(Noise, IsHeldAndThenDrawnAgain) {
  const Trajectory trajectory(test::rppRobot(), noisySetPoint(1));
  for (int hold = 0; hold < 100; ++hold) {
    const JointVector held = referenceAt(trajectory, 0.1 * hold).q;
    for (const double t : {0.0005, 0.05, 0.0995}) EXPECT_EQ(referenceAt(trajectory, 0.1 * hold + t).q, held);
    EXPECT_NE(referenceAt(trajectory, 0.1 * (hold + 1)).q, held);
  }
}

TEST(Noise, HasTheDeviationAskedForOnEachJoint) {
  const Trajectory trajectory(test::rppRobot(), noisySetPoint(1));
  constexpr int n = 10'000;
  JointVector sum = Vector3::Zero(), squares = Vector3::Zero();
  for (int hold = 0; hold < n; ++hold) {
    const JointVector noise = referenceAt(trajectory, 0.1 * hold).q - Vector3(0.5, 0.2, 0.1);
    sum += noise;
    squares += noise.cwiseAbs2();
  }
  const Vector3 deviation(0.1, 0.02, 0.02);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(sum(i) / n, 0.0, kSigmas * deviation(i) / std::sqrt(n)) << i;
    // The scatter of a measured standard deviation is sigma / sqrt(2 n).
    EXPECT_NEAR(std::sqrt(squares(i) / n), deviation(i), kSigmas * deviation(i) / std::sqrt(2.0 * n)) << i;
  }
}

TEST(Noise, RepeatsWithItsSeedAndOnlyWithIt) {
  const Trajectory one(test::rppRobot(), noisySetPoint(1)), same(test::rppRobot(), noisySetPoint(1)),
      other(test::rppRobot(), noisySetPoint(2));
  for (const double t : {5.0, 0.3, 59.9, 0.0, 0.3}) {  // in any order
    EXPECT_EQ(referenceAt(one, t).q, referenceAt(same, t).q);
    EXPECT_NE(referenceAt(one, t).q, referenceAt(other, t).q);
  }
}

TEST(Noise, IsOnTheJointPositionAndOnNothingElse) {
  TrajectorySpec spec{.motion = JointPath{.waypoints = {{0.0, Vector3(0, 0, 0)}, {2.0, Vector3(0.5, 0.2, 0.1)}}}};
  const Trajectory clean(test::rppRobot(), spec);
  spec.noise = noisySetPoint(1).noise;
  const Trajectory noisy(test::rppRobot(), spec);
  for (double t = 0.0; t < 3.0; t += 0.1) {
    const Reference expected = referenceAt(clean, t), found = referenceAt(noisy, t);
    EXPECT_NE(found.q, expected.q) << t;
    EXPECT_EQ(found.qd, expected.qd) << t;
    EXPECT_EQ(found.qdd, expected.qdd) << t;
    EXPECT_EQ(found.X_WE.p, expected.X_WE.p) << t;
    EXPECT_EQ(found.X_WE.R, expected.X_WE.R) << t;
    EXPECT_EQ(found.V_WE, expected.V_WE) << t;
    EXPECT_EQ(found.A_WE, expected.A_WE) << t;
  }
}

TEST(Noise, IsMadeWithoutAllocating) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer has its own malloc";
  const Trajectory trajectory(test::rppRobot(), noisySetPoint(1));
  Reference reference;
  const test::AllocationGuard guard;
  for (double t = 0.0; t < 5.0; t += 0.01) trajectory.evaluate(t, reference);
  EXPECT_EQ(guard.count(), 0u);
}

}  // namespace
}  // namespace baton
