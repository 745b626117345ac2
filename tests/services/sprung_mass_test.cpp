/// The theory of the co-simulation study against itself by other roads: closed forms against eigenvalues, eigenvalues
/// against series, and the scenarios it is read from.
#include "report/sprung_mass.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "runtime/paths.hpp"

namespace baton::theory {
namespace {

constexpr int kExact = 64;  // sub-steps, so many that RK4 is exact to rounding

double radius(const SprungMass& mass, Coupling coupling, double dt) {
  return spectralRadius(stepMap(mass, coupling, dt, kExact));
}

TEST(SprungMass, ClosedFormsAreWhereTheEigenvaluesCrossTheUnitCircle) {
  for (const double D : {2.0, 20.0, 60.0}) {
    for (const double K : {20.0, 300.0, 5000.0, 1e5}) {
      const SprungMass mass{.m = 1.1583, .K = K, .D = D};
      for (const Coupling coupling : kCouplings) {
        const double limit = stableStep(mass, coupling);
        EXPECT_LT(radius(mass, coupling, 0.9999 * limit), 1.0) << toString(coupling) << " K " << K << " D " << D;
        EXPECT_GT(radius(mass, coupling, 1.0001 * limit), 1.0) << toString(coupling) << " K " << K << " D " << D;
      }
    }
  }
}

TEST(SprungMass, IsStableAtEveryStepBelowTheLimit) {
  const SprungMass mass{.m = 1.1583, .K = 2000.0, .D = 20.0};
  for (const Coupling coupling : kCouplings) {
    for (double part = 0.01; part < 1.0; part += 0.01) {
      EXPECT_LT(radius(mass, coupling, part * stableStep(mass, coupling)), 1.0) << toString(coupling) << ' ' << part;
    }
  }
}

TEST(SprungMass, GrowsAtTheRateOfTheNegativeDampingToFirstOrder) {
  const SprungMass mass{.m = 1.1583, .K = 1000.0, .D = 0.0};
  const double omega = std::sqrt(mass.K / mass.m);
  for (const Coupling coupling : {Coupling::kHeld, Coupling::kLate}) {
    for (const double dt : {1e-3, 1e-4}) {
      const double rate = std::log(radius(mass, coupling, dt)) / dt;
      const double predicted = -couplingDamping(mass, coupling, dt) / (2.0 * mass.m);
      EXPECT_NEAR(rate / predicted, 1.0, 2.0 * std::pow(omega * dt, 2)) << toString(coupling) << ' ' << dt;
    }
  }
  // RK4 alone: |1 + iz - z^2/2 - iz^3/6 + z^4/24|^2 = 1 - z^6/72 + z^8/576.
  const double z = omega * 1e-2;
  EXPECT_NEAR(std::pow(spectralRadius(stepMap(mass, Coupling::kDerivatives, 1e-2, 1)), 2),
              1.0 - std::pow(z, 6) / 72.0 + std::pow(z, 8) / 576.0, 1e-14);
}

TEST(SprungMass, MeasuresTheGrowthOfAKnownMotion) {
  Eigen::VectorXd x(4000);
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double t = 1e-3 * static_cast<double>(k);
    x(k) = 0.01 * std::exp(0.37 * t) * std::cos(29.0 * t + 0.3);
  }
  EXPECT_NEAR(measuredGrowth(x, 1e-3), 0.37, 1e-9);
}

TEST(SprungMass, IsReadFromTheStudysScenarios) {
  const Scenario spring = loadScenario(findScenario("cosim/spring_held").string());
  const SprungMass undamped = sprungMassOf(spring);
  EXPECT_NEAR(undamped.m, 1.1583, 1e-9);
  EXPECT_EQ(undamped.K, 1000.0);
  EXPECT_EQ(undamped.D, 0.0);
  EXPECT_EQ(spring.coupling, Coupling::kHeld);
  const Scenario damped = loadScenario(findScenario("cosim/damped_spring").string());
  EXPECT_NEAR(sprungMassOf(damped).D, 20.0, 1e-9);
  // What the file's head says.
  EXPECT_NEAR(stableStep(sprungMassOf(damped), Coupling::kHeld), 0.020, 1e-12);
  EXPECT_NEAR(stableStep(sprungMassOf(damped), Coupling::kDerivatives), 0.057, 5e-4);
  EXPECT_THROW((void)sprungMassOf(loadScenario(findScenario("report/fig44_admittance").string())), UsageError);
  EXPECT_THROW((void)sprungMassOf(loadScenario(findScenario("cosim/touch").string())), UsageError);
}

}  // namespace
}  // namespace baton::theory
