#include "control/mass_spring_damper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace baton {
namespace {

using State = MassSpringDamper::State;

/// The exact solution from (z0, zd0) under a constant force, by the roots of its characteristic polynomial.
State byRoots(double m, double d, double k, const State& start, double f, double t) {
  const double sigma = d / (2 * m), square = sigma * sigma - k / m;
  const double r = std::sqrt(std::abs(square));
  const double C = square > 0 ? std::cosh(r * t) : std::cos(r * t);
  const double S = square > 0 ? std::sinh(r * t) / r : square < 0 ? std::sin(r * t) / r : t;
  const double e = std::exp(-sigma * t), rest = f / k, z0 = start.z - rest, zd0 = start.zd;
  return {rest + e * (C * z0 + S * (zd0 + sigma * z0)), e * (C * zd0 - S * (sigma * zd0 + k / m * z0))};
}

TEST(MassSpringDamper, IsTheExactSolutionForAHeldForce) {
  struct Case {
    double m, d, k;
  };
  const State start{0.3, -1.2};
  for (const Case& c : std::vector<Case>{{1, 30, 200}, {2, 4, 50}, {1, 20, 100}, {0.5, 0, 8}, {1, 300, 1}}) {
    for (const double t : {1e-6, 5e-4, 0.01, 0.3, 4.0}) {
      MassSpringDamper msd(c.m, c.d, c.k);
      const State actual = msd.advanced(start, 3.0, t), expected = byRoots(c.m, c.d, c.k, start, 3.0, t);
      EXPECT_NEAR(actual.z, expected.z, 1e-12 * (1 + 3.0 / c.k)) << c.d << " " << c.k << " " << t;
      EXPECT_NEAR(actual.zd, expected.zd, 1e-12 * (1 + 3.0 / c.k)) << c.d << " " << c.k << " " << t;
    }
  }
}

TEST(MassSpringDamper, WithoutSpringOrDamperIsFreeMotion) {
  const double t = 0.7;
  const State flying = MassSpringDamper(2.0, 0.0, 0.0).advanced({1.0, 3.0}, 4.0, t);
  EXPECT_NEAR(flying.z, 1.0 + 3.0 * t + 0.5 * 2.0 * t * t, 1e-14);
  EXPECT_NEAR(flying.zd, 3.0 + 2.0 * t, 1e-14);
  const State braked = MassSpringDamper(2.0, 1.0, 0.0).advanced({1.0, 3.0}, 0.0, t);
  EXPECT_NEAR(braked.zd, 3.0 * std::exp(-0.5 * t), 1e-14);
  EXPECT_NEAR(braked.z, 1.0 + 6.0 * (1.0 - std::exp(-0.5 * t)), 1e-14);
}

TEST(MassSpringDamper, ManyStepsAreOneAndTheStepMayChange) {
  MassSpringDamper msd(1.0, 30.0, 200.0), once(1.0, 30.0, 200.0);
  State state{0.1, 0.2};
  for (int i = 0; i < 1000; ++i) state = msd.advanced(state, 5.0, i % 2 == 0 ? 4e-4 : 6e-4);
  const State whole = once.advanced({0.1, 0.2}, 5.0, 0.5);
  EXPECT_NEAR(state.z, whole.z, 1e-13);
  EXPECT_NEAR(state.zd, whole.zd, 1e-13);
}

TEST(MassSpringDamper, AccelerationIsItsEquation) {
  EXPECT_DOUBLE_EQ(MassSpringDamper(2.0, 3.0, 5.0).acceleration({0.7, -0.4}, 9.0), (9.0 + 3.0 * 0.4 - 5.0 * 0.7) / 2.0);
}

}  // namespace
}  // namespace baton
