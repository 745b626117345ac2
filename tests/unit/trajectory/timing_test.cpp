#include "trajectory/timing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace baton {
namespace {

const std::vector<Timing> kAll{{.interpolation = Interpolation::kCubic},
                               {.interpolation = Interpolation::kQuintic},
                               {.interpolation = Interpolation::kTrapezoidal},
                               {.interpolation = Interpolation::kTrapezoidal, .ramp = 0.1},
                               {.interpolation = Interpolation::kTrapezoidal, .ramp = 0.5}};

TEST(Timing, GoesFromRestAtZeroToRestAtOne) {
  for (const Timing& timing : kAll) {
    const Progress start = progressAt(timing, 0.0), end = progressAt(timing, 1.0);
    EXPECT_EQ(start.s, 0.0);
    EXPECT_EQ(start.ds, 0.0);
    EXPECT_EQ(end.s, 1.0);
    EXPECT_EQ(end.ds, 0.0);
  }
}

TEST(Timing, NeverGoesBackAndIsTheSameFromEitherEnd) {
  for (const Timing& timing : kAll) {
    for (double u = 0.0; u <= 1.0; u += 1.0 / 64.0) {
      const Progress there = progressAt(timing, u), back = progressAt(timing, 1.0 - u);
      EXPECT_GE(there.ds, 0.0) << u;
      EXPECT_NEAR(there.s + back.s, 1.0, 1e-15) << u;
      EXPECT_NEAR(there.ds, back.ds, 1e-14) << u;
    }
  }
}

TEST(Timing, DerivativesAreThoseOfTheProgress) {
  // Off by h^2 / 6 times the third derivative, at most 60, and by rounding of 1e-16 / h. No point lies within h of
  // where a trapezium bends.
  constexpr double h = 1e-5;
  for (const Timing& timing : kAll) {
    for (double u = 0.0123; u < 1.0; u += 0.0377) {
      const Progress now = progressAt(timing, u), before = progressAt(timing, u - h), after = progressAt(timing, u + h);
      EXPECT_NEAR((after.s - before.s) / (2 * h), now.ds, 1e-8) << u;
      EXPECT_NEAR((after.ds - before.ds) / (2 * h), now.dds, 1e-8) << u;
    }
  }
}

TEST(Timing, HasTheTextbookPeaks) {
  // Peak speed and acceleration for a way of 1 in a time of 1: 3/2 and 6 for the cubic, 15/8 and 10/sqrt(3) for the
  // quintic, 1/(1 - r) and 1/(r (1 - r)) for the trapezium.
  const std::vector<std::pair<double, double>> expected{
      {1.5, 6.0}, {1.875, 10.0 / std::sqrt(3.0)}, {4.0 / 3.0, 16.0 / 3.0}, {1.0 / 0.9, 1.0 / 0.09}, {2.0, 4.0}};
  for (std::size_t i = 0; i < kAll.size(); ++i) {
    double speed = 0.0, acceleration = 0.0;
    constexpr int kPoints = 10'000;
    for (int k = 0; k <= kPoints; ++k) {
      const Progress progress = progressAt(kAll[i], static_cast<double>(k) / kPoints);
      speed = std::max(speed, progress.ds);
      acceleration = std::max(acceleration, std::abs(progress.dds));
    }
    EXPECT_NEAR(speed, expected[i].first, 1e-7) << i;
    EXPECT_NEAR(acceleration, expected[i].second, 1e-6) << i;  // between two points by (1/10000)^2 x 60
  }
}

TEST(Timing, TrapeziumRampsUpStaysAndRampsDown) {
  const Timing timing{.interpolation = Interpolation::kTrapezoidal, .ramp = 0.2};
  for (const double u : {0.25, 0.5, 0.75}) {
    EXPECT_EQ(progressAt(timing, u).ds, 1.25);
    EXPECT_EQ(progressAt(timing, u).dds, 0.0);
  }
  EXPECT_EQ(progressAt(timing, 0.1).ds, 0.625);
  EXPECT_EQ(progressAt(timing, 0.1).dds, 6.25);
  EXPECT_EQ(progressAt(timing, 0.9).dds, -6.25);
}

}  // namespace
}  // namespace baton
