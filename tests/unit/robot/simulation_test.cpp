#include "robot/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Motion {
  JointVector q, qd;
};

using Environment = std::function<Contact(const Vector3& p, const Vector3& v)>;

Contact noContact(const Vector3&, const Vector3&) { return {}; }

/// Simulates `steps` control steps over duration_s without effort; one sub-step each.
Motion simulate(const RobotModel& model, Motion motion, double duration_s, int steps,
                const Environment& environment = noContact) {
  const JointVector tau = JointVector::Zero(model.size());
  Kinematics kinematics;
  for (int k = 0; k < steps; ++k) {
    computeKinematics(model, motion.q, motion.qd, kinematics);
    const Contact contact = environment(kinematics.X_WE.p, kinematics.V_WE.head<3>());
    EXPECT_TRUE(integrateStep(model, tau, contact, duration_s / steps, 1, motion.q, motion.qd));
  }
  return motion;
}

double energy(const RobotModel& model, const Motion& motion) {
  return kineticEnergy(model, motion.q, motion.qd) + potentialEnergy(model, motion.q);
}

double distance(const Motion& a, const Motion& b) { return (a.q - b.q).norm() + (a.qd - b.qd).norm(); }

constexpr double kMass = 2.0, kStiffness = 800.0, kOmega = 20.0;  // omega = sqrt(K / m)
/// A spring along z from the origin, and a damper. Held: without the derivatives.
Environment spring(bool held, double damping = 0.0) {
  return [=](const Vector3& p, const Vector3& v) {
    Contact contact;
    contact.h_e(2) = kStiffness * p.z() + damping * v.z();
    if (!held) {
      contact.df_dp(2, 2) = kStiffness;
      contact.df_dv(2, 2) = damping;
    }
    return contact;
  };
}

/// A wall at z = 0 that only pushes.
Environment wall(bool held) {
  return [=](const Vector3& p, const Vector3& v) { return p.z() > 0.0 ? spring(held)(p, v) : Contact{}; };
}

TEST(IntegrateStep, ConservesEnergyAndConvergesWithTheFourthPower) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const RobotModel model = test::randomChain(4, 50 + seed);
    std::mt19937 generator(seed);
    const Motion start{test::randomJointVector(generator, 4, 1.0), test::randomJointVector(generator, 4, 1.0)};
    const Motion exact = simulate(model, start, 0.4, 1600);
    const Motion coarse = simulate(model, start, 0.4, 50), fine = simulate(model, start, 0.4, 100);

    // Halving dt divides an error of order 4 by 16; the rest is the next order.
    const double ratio = distance(coarse, exact) / distance(fine, exact);
    EXPECT_GT(ratio, 11.0) << seed;
    EXPECT_LT(ratio, 24.0) << seed;

    const double scale = 1.0 + kineticEnergy(model, start.q, start.qd);
    const auto drift = [&](const Motion& motion) { return std::abs(energy(model, motion) - energy(model, start)); };
    EXPECT_LT(drift(exact), 1e-9 * scale) << seed;
    // The energy's own error is one smooth function of the motion's: it falls as fast, up to its sign.
    EXPECT_GT(drift(coarse), 8.0 * drift(fine)) << seed;
  }
}

TEST(IntegrateStep, SplitsAStepIntoEqualSubsteps) {
  const RobotModel robot = test::rppRobot();
  const Vector3 tau(1.0, -0.5, 0.3);
  JointVector q = Vector3(0.1, 0.02, 0.02), qd = Vector3(0.3, -0.2, 0.1);
  JointVector q_by_hand = q, qd_by_hand = qd;
  ASSERT_TRUE(integrateStep(robot, tau, Contact{}, 0.01, 4, q, qd));
  for (int k = 0; k < 4; ++k) ASSERT_TRUE(integrateStep(robot, tau, Contact{}, 0.0025, 1, q_by_hand, qd_by_hand));
  EXPECT_EQ(q, q_by_hand);
  EXPECT_EQ(qd, qd_by_hand);
}

TEST(IntegrateStep, FollowsAPendulumOfSmallSwing) {
  // link1 without friction: I qdd + m g d sin q = 0, period 2 pi sqrt(I / (m g d)) times 1 + q0^2 / 16.
  RobotModel robot = test::link1Robot();
  robot.joints[0].friction = {};
  const double amplitude = 0.01, moment = 1.1 * 1.1 * 3.5 * 2.7 * 9.806 * 1.75;
  const double period = 2.0 * kPi * std::sqrt(0.1 / moment) * (1.0 + amplitude * amplitude / 16.0);
  const Motion start{JointVector::Constant(1, amplitude), JointVector::Zero(1)};
  const Motion after = simulate(robot, start, period, 1000);
  EXPECT_NEAR(after.q(0), amplitude, 1e-6 * amplitude);
  EXPECT_NEAR(after.qd(0) * period, 0.0, 1e-5 * amplitude);
}

TEST(IntegrateStep, LosesEnergyToFrictionAndToNothingElse) {
  RobotModel model = test::randomChain(3, 5);
  for (Joint& joint : model.joints) joint.friction = {.viscous = 0.5, .coulomb = 1.0, .coulomb_velocity = 0.05};
  std::mt19937 generator(5);
  Motion motion{test::randomJointVector(generator, 3, 1.0), test::randomJointVector(generator, 3, 1.0)};
  double before = energy(model, motion);
  for (int k = 0; k < 500; ++k) {
    const Motion start = motion;
    motion = simulate(model, motion, 1e-3, 1);
    const double after = energy(model, motion);
    EXPECT_LT(after, before);
    // The power of friction, by the trapezoid over the step.
    JointVector friction_0, friction_1;
    frictionEffort(model, start.qd, friction_0);
    frictionEffort(model, motion.qd, friction_1);
    const double lost = 0.5e-3 * (friction_0.dot(start.qd) + friction_1.dot(motion.qd));
    EXPECT_NEAR(before - after, lost, 1e-3 * lost + 1e-6);
    before = after;
  }
}

TEST(IntegrateStep, RefusesAStateThatIsNotFiniteAndLeavesItAlone) {
  const RobotModel robot = test::rppRobot();
  JointVector q = Vector3(0.1, 0.2, 0.3), qd = Vector3(0.3, 0.2, 0.1);
  const JointVector q0 = q, qd0 = qd;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(integrateStep(robot, Vector3(nan, 0.0, 0.0), Contact{}, 1e-3, 2, q, qd));
  EXPECT_FALSE(integrateStep(robot, Vector3(1e308, 1e308, 1e308), Contact{}, 1e3, 2, q, qd));
  EXPECT_EQ(q, q0);
  EXPECT_EQ(qd, qd0);
}

TEST(ContactFollowing, KeepsTheEnergyOfASpringThatAHeldForceFeeds) {
  // Half a swing against the spring. A force held over dt is dt/2 late: damping -K dt/2, so the energy grows by
  // exp(pi omega dt / 2). Followed, only the error of RK4 is left: a loss of (omega dt)^6 / 72 a step.
  const RobotModel robot = test::slider(kMass);
  const double swing_s = kPi / kOmega;
  const Motion start{JointVector::Zero(1), JointVector::Constant(1, 1.0)};
  const auto gain = [&](bool held, int steps) {
    const Motion end = simulate(robot, start, swing_s, steps, spring(held));
    return (kMass * end.qd.squaredNorm() + kStiffness * end.q.squaredNorm()) / kMass - 1.0;
  };
  for (const int steps : {50, 100}) {
    const double omega_dt = kPi / steps;
    const double predicted = std::expm1(kPi * omega_dt / 2.0);
    EXPECT_NEAR(gain(true, steps), predicted, 0.1 * predicted) << steps;
    EXPECT_LT(std::abs(gain(false, steps)), 2.0 * steps * std::pow(omega_dt, 6) / 72.0) << steps;
  }
}

TEST(ContactFollowing, BouncesOffAWallWithTheSpeedItCameWith) {
  // Meeting and leaving the wall inside a step costs at most the spring energy of one step's travel, (omega dt)^2 of
  // the whole, at each end; the held force adds its first-order gain to that.
  const RobotModel robot = test::slider(kMass);
  const auto gain = [&](bool held, double omega_dt) {
    const Motion start{JointVector::Constant(1, -0.01), JointVector::Constant(1, 1.0)};
    const int steps = static_cast<int>(260.0 * 1e-3 * kOmega / omega_dt);
    const Motion end = simulate(robot, start, steps * omega_dt / kOmega, steps, wall(held));
    EXPECT_LT(end.q(0), 0.0);  // it is back outside
    return end.qd.squaredNorm() - 1.0;
  };
  for (const double omega_dt : {0.04, 0.02, 0.01}) {
    EXPECT_LT(std::abs(gain(false, omega_dt)), 2.0 * omega_dt * omega_dt) << omega_dt;
    EXPECT_NEAR(gain(true, omega_dt), kPi * omega_dt / 2.0, 4.0 * omega_dt * omega_dt) << omega_dt;
  }
}

TEST(ContactFollowing, FollowsVelocityToo) {
  // m z'' + c z' + K z = 0 from z = 0: z = exp(-s t) sin(w t) v0 / w.
  const double damping = 10.0, duration_s = 0.2;
  const double s = damping / (2.0 * kMass), w = std::sqrt(kOmega * kOmega - s * s);
  const Motion start{JointVector::Zero(1), JointVector::Constant(1, 1.0)};
  const Motion end = simulate(test::slider(kMass), start, duration_s, 200, spring(false, damping));
  const double expected = std::exp(-s * duration_s) * std::sin(w * duration_s) / w;
  EXPECT_NEAR(end.q(0), expected, 1e-8);  // (omega dt)^4 / 120 of the swing
}

TEST(ContactFollowing, KeepsTheFourthOrderOnABendingArm) {
  const RobotModel robot = test::rppRobot();
  const auto stiff_ceiling = [](bool held) -> Environment {
    return [held](const Vector3& p, const Vector3&) {
      Contact contact;
      contact.h_e(2) = 200.0 * (p.z() - 0.70);
      if (!held) contact.df_dp(2, 2) = 200.0;
      return contact;
    };
  };
  const Motion start{Vector3(0.6, 0.1, 0.05), Vector3(0.5, 0.1, -0.2)};
  const Motion exact = simulate(robot, start, 0.2, 3200, stiff_ceiling(false));
  const auto error = [&](bool held, int steps) {
    return distance(simulate(robot, start, 0.2, steps, stiff_ceiling(held)), exact);
  };
  EXPECT_NEAR(error(true, 100) / error(true, 200), 2.0, 0.4);
  EXPECT_GT(error(false, 100) / error(false, 200), 11.0);  // 16, or better where terms of the error cancel
  EXPECT_LT(error(false, 100), 1e-3 * error(true, 100));
}

TEST(SaturateEffort, CutsEachJointAtItsLimitAndCounts) {
  RobotModel robot = test::rppRobot();
  robot.joints[0].effort_limit = 20.0;
  robot.joints[1].effort_limit = 10.0;
  JointVector tau = Vector3(713.0, -10.5, 1e6);
  EXPECT_EQ(saturateEffort(robot, tau), 2);
  EXPECT_EQ(tau, Vector3(20.0, -10.0, 1e6));  // joint 3 has no limit
  EXPECT_EQ(saturateEffort(robot, tau), 0);   // on the limit is not cut
}

}  // namespace
}  // namespace baton
