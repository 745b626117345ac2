/// What each coupling rule makes of a wall, held against theory. A mass m on a spring K sees a force that is half a
/// step late (held) or one and a half (late); to first order in dt that is damping of -K dt/2 and -3 K dt/2.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "control/arm.hpp"
#include "robot/simulation.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kMass = 2.0, kStiffness = 800.0, kOmega = 20.0;  // omega = sqrt(K / m)
constexpr double kStart = 1e-12;  // all of it is linear; what grows a million times must not run away yet [m]

/// The mass on a spring of stiffness K about z = 0, one RK4 step a control step.
class SprungMass {
 public:
  SprungMass(Coupling coupling, double dt, double stiffness = kStiffness, double damping = 0.0, int substeps = 1)
      : stiffness_(stiffness), damping_(damping), arm_(robot_, configOf(coupling, dt, substeps)) {}

  /// `damping` acts through the torque, which is held. False when the motion has run away.
  bool step() {
    Contact contact;
    contact.h_e(2) = stiffness_ * z();
    contact.df_dp(2, 2) = stiffness_;
    return arm_.move(-damping_ * arm_.state().qd, contact);
  }
  [[nodiscard]] double z() const { return arm_.state().q(0); }
  [[nodiscard]] double energy() const {
    return 0.5 * (kMass * arm_.state().qd.squaredNorm() + stiffness_ * arm_.state().q.squaredNorm());
  }

 private:
  static ArmConfig configOf(Coupling coupling, double dt, int substeps) {
    return {.step_s = dt,
            .substeps = substeps,
            .start_q = JointVector::Constant(1, kStart),
            .start_qd = JointVector::Zero(1),
            .coupling = coupling};
  }
  const RobotModel robot_ = test::slider(kMass);
  double stiffness_, damping_;
  Arm arm_;
};

/// Rate at which the amplitude grows, over a hundred swings [1/s]. Any two modes of a linear recurrence make
/// z(k) z(k + 2) - z(k + 1)^2 grow by exactly the product of their multipliers a step.
double growthRate(Coupling coupling, double dt) {
  SprungMass mass(coupling, dt);
  const auto area = [&] {
    const double first = mass.z();
    EXPECT_TRUE(mass.step());
    const double second = mass.z();
    EXPECT_TRUE(mass.step());
    return std::abs(first * mass.z() - second * second);
  };
  for (int k = 0; k < 20; ++k) EXPECT_TRUE(mass.step());  // the third mode of the late rule fades within a few steps
  const double before = area();
  const int steps = static_cast<int>(628.0 / kOmega / dt);
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(mass.step());
  return std::log(area() / before) / (2.0 * (steps + 2) * dt);
}

/// The damping that would change the amplitude so: m z'' + d z' + K z = 0 has the rate -d / (2 m).
double damping(Coupling coupling, double dt) { return -2.0 * kMass * growthRate(coupling, dt); }

TEST(Coupling, KeepsTheForceOfTheRightStep) {
  const RobotModel robot = test::rppRobot();
  const JointVector start = Vector3(0.3, 0.05, 0.1), tau = Vector3(1.0, 2.0, 3.0);
  Contact first, second;
  first.h_e << 1.0, 2.0, 3.0, 0.0, 0.0, 0.1;
  second.h_e << -4.0, 5.0, 6.0, 0.2, 0.0, 0.0;
  first.df_dp = second.df_dp = 100.0 * Matrix3::Identity();
  first.df_dv = second.df_dv = 10.0 * Matrix3::Identity();
  const auto kept = [](const Contact& contact) {
    Contact force;
    force.h_e = contact.h_e;
    return force;
  };
  const auto expectMotion = [&](Coupling coupling, const Contact& over_first, const Contact& over_second) {
    Arm arm(
        robot,
        {.step_s = 1e-3, .substeps = 2, .start_q = start, .start_qd = Vector3(0.4, -0.3, 0.2), .coupling = coupling});
    JointVector q = start, qd = Vector3(0.4, -0.3, 0.2);
    ASSERT_TRUE(arm.move(tau, first));
    ASSERT_TRUE(integrateStep(robot, tau, over_first, 1e-3, 2, q, qd));
    EXPECT_EQ(arm.state().q, q) << toString(coupling);
    ASSERT_TRUE(arm.move(tau, second));
    ASSERT_TRUE(integrateStep(robot, tau, over_second, 1e-3, 2, q, qd));
    EXPECT_EQ(arm.state().q, q) << toString(coupling);
    EXPECT_EQ(arm.state().qd, qd) << toString(coupling);
  };
  expectMotion(Coupling::kDerivatives, first, second);
  expectMotion(Coupling::kHeld, kept(first), kept(second));
  expectMotion(Coupling::kLate, kept(first), kept(first));
}

TEST(Coupling, AForceThatIsKeptIsNegativeDampingToFirstOrder) {
  for (const auto& [coupling, late_steps] : {std::pair{Coupling::kHeld, 0.5}, std::pair{Coupling::kLate, 1.5}}) {
    const auto deviation = [&, rule = coupling, late = late_steps](double dt) {
      return damping(rule, dt) / (-kStiffness * late * dt) - 1.0;
    };
    // What is beyond the first order is of the order of (omega dt)^2: small, and a quarter at half the step.
    const double coarse = deviation(2e-3), fine = deviation(1e-3);
    EXPECT_LT(std::abs(coarse), 4.0 * std::pow(kOmega * 2e-3, 2)) << toString(coupling);
    EXPECT_NEAR(coarse / fine, 4.0, 0.1) << toString(coupling);
  }
}

TEST(Coupling, WithDerivativesOnlyTheIntegratorsOwnLossIsLeft) {
  // RK4 multiplies the amplitude by 1 - (omega dt)^6 / 144 a step, to the order after.
  const auto rate = [](double dt) { return growthRate(Coupling::kDerivatives, dt); };
  for (const double dt : {5e-3, 2.5e-3}) {
    const double predicted = -std::pow(kOmega * dt, 6) / (144.0 * dt);
    EXPECT_NEAR(rate(dt), predicted, 0.02 * std::abs(predicted)) << dt;
    EXPECT_LT(std::abs(rate(dt)), 1e-4 * growthRate(Coupling::kHeld, dt)) << dt;
  }
  EXPECT_NEAR(rate(5e-3) / rate(2.5e-3), 32.0, 1.0);
}

/// Whether the motion of a damped mass grows: from one window of many swings to the next, by the peaks of its energy.
bool grows(Coupling coupling, double dt, double stiffness, double damping) {
  SprungMass mass(coupling, dt, stiffness, damping, 8);
  const auto peak = [&] {
    double energy = 0.0;
    for (int k = 0; k < 1500; ++k) {
      if (!mass.step()) return std::numeric_limits<double>::infinity();
      energy = std::max(energy, mass.energy());
    }
    return energy;
  };
  const double early = peak();
  return std::isinf(early) || peak() > early;
}

TEST(Coupling, IsStableUpToTheStepThatTheoryGives) {
  // Under a held torque -D v the map of one step has its eigenvalues inside the unit circle, by Jury's criterion, for
  //   held         D > K dt/2
  //   late         b > z (6 + z) / (2 (2 + z)),  b = D dt/m, z = K dt^2/m
  //   derivatives  D / sqrt(m K) < cot(omega dt/2)
  // as long as D dt < 2 m, beyond which the held damping itself overshoots.
  constexpr double kDamping = 10.0;
  for (const double stiffness : {400.0, 3200.0}) {
    const double omega = std::sqrt(stiffness / kMass);
    const auto late_margin = [&](double dt) {
      const double z = stiffness * dt * dt / kMass;
      return kDamping * dt / kMass - z * (6.0 + z) / (2.0 * (2.0 + z));
    };
    double low = 1e-6, high = 1.0;
    while (high - low > 1e-9) (late_margin((low + high) / 2.0) > 0.0 ? low : high) = (low + high) / 2.0;
    const std::pair<Coupling, double> limits[] = {
        {Coupling::kHeld, 2.0 * kDamping / stiffness},
        {Coupling::kLate, low},
        {Coupling::kDerivatives, 2.0 / omega * std::atan(std::sqrt(kMass * stiffness) / kDamping)}};
    for (const auto& [coupling, limit] : limits) {
      ASSERT_LT(kDamping * limit, 2.0 * kMass);
      EXPECT_FALSE(grows(coupling, 0.98 * limit, stiffness, kDamping)) << toString(coupling) << " at " << stiffness;
      EXPECT_TRUE(grows(coupling, 1.02 * limit, stiffness, kDamping)) << toString(coupling) << " at " << stiffness;
    }
  }
}

}  // namespace
}  // namespace baton
