#include "trajectory/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/error.hpp"
#include "derivatives.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr auto kAll = {Interpolation::kCubic, Interpolation::kQuintic, Interpolation::kTrapezoidal};

using test::expectDerivatives;
using test::referenceAt;

JointPath::Waypoint at(double time_s, double q1, double q2, double q3) { return {time_s, Vector3(q1, q2, q3)}; }

JointPath reportTq(Interpolation interpolation) {
  return {
      .timing = {.interpolation = interpolation},
      .waypoints = {at(0, 0, 0, 0), at(1, kPi / 4, 0.2, 0.05), at(2, -kPi / 6, 0.05, 0.2), at(3, kPi / 3, 0.1, 0.1)}};
}

JointPath reportTx(Interpolation interpolation = Interpolation::kQuintic) {
  return {.timing = {.interpolation = interpolation}, .waypoints = {at(0, 0, 0, 0), at(2, kPi / 6, 0.2, 0.1)}};
}

TEST(Trajectory, PassesEveryWaypointAtRest) {
  for (const Interpolation interpolation : kAll) {
    const JointPath path = reportTq(interpolation);
    const Trajectory trajectory(test::rppRobot(), {.motion = path});
    for (const auto& waypoint : path.waypoints) {
      const Reference reference = referenceAt(trajectory, waypoint.time_s);
      EXPECT_EQ(reference.q, waypoint.q);
      EXPECT_TRUE(reference.qd.isZero(0.0));
      EXPECT_TRUE(reference.V_WE.isZero(0.0));
      if (interpolation == Interpolation::kQuintic) {
        EXPECT_TRUE(reference.qdd.isZero(0.0));
        EXPECT_TRUE(reference.A_WE.isZero(0.0));
      }
    }
    EXPECT_EQ(trajectory.endTime(), 3.0);
  }
}

TEST(Trajectory, HoldsBeforeTheFirstAndAfterTheLastWaypoint) {
  JointPath path = reportTq(Interpolation::kCubic);
  for (auto& waypoint : path.waypoints) waypoint.time_s += 1.5;
  const Trajectory trajectory(test::rppRobot(), {.motion = path});
  for (const double t : {-1.0, 0.0, 1.499, 4.5, 4.501, 1e9}) {
    const Reference reference = referenceAt(trajectory, t);
    EXPECT_EQ(reference.q, t < 2.0 ? path.waypoints.front().q : path.waypoints.back().q) << t;
    EXPECT_TRUE(reference.qd.isZero(0.0) && reference.qdd.isZero(0.0)) << t;
    EXPECT_TRUE(reference.V_WE.isZero(0.0) && reference.A_WE.isZero(0.0)) << t;
  }
}

TEST(Trajectory, OneWaypointIsASetPoint) {
  const RobotModel robot = test::rppRobot();
  const Trajectory trajectory(robot, {.motion = JointPath{.waypoints = {at(0, kPi / 3, 0.1, 0.1)}}});
  for (const double t : {-1.0, 0.0, 7.0}) {
    const Reference reference = referenceAt(trajectory, t);
    EXPECT_EQ(reference.q, Vector3(kPi / 3, 0.1, 0.1));
    EXPECT_TRUE(reference.qd.isZero(0.0) && reference.qdd.isZero(0.0));
    EXPECT_TRUE(reference.has_task);
    EXPECT_NEAR((reference.X_WE.p - Vector3(0.3250, -0.5600, 0.9629)).norm(), 0.0, 1e-4);  // the report's four digits
  }
}

TEST(Trajectory, TxEndsAtTheReportsTaskPointAndCarriesTheWrench) {
  const Vector6 h_d = (Vector6() << 0, 0, 3, 0, 0, 0).finished();
  const Trajectory trajectory(test::rppRobot(), {.motion = reportTx(), .h_d = h_d});
  for (const double t : {2.0, 8.0}) {
    const Reference reference = referenceAt(trajectory, t);
    EXPECT_NEAR((reference.X_WE.p - Vector3(0.5629, -0.66, 0.725)).norm(), 0.0, 1e-4);
    EXPECT_EQ(reference.h_d, h_d);
  }
}

TEST(Trajectory, HalfWayIsTheMiddleAtTheTextbookPeakSpeed) {
  // Peak speed over mean speed: 3/2 for the cubic, 15/8 for the quintic, 1/(1 - 1/4) for the trapezium; none has
  // acceleration there.
  const JointVector distance = reportTx().waypoints[1].q;
  for (const auto& [interpolation, peak] : {std::pair(Interpolation::kCubic, 1.5),
                                            {Interpolation::kQuintic, 1.875},
                                            {Interpolation::kTrapezoidal, 4.0 / 3.0}}) {
    const Trajectory trajectory(test::rppRobot(), {.motion = reportTx(interpolation)});
    const Reference reference = referenceAt(trajectory, 1.0);
    EXPECT_LT((reference.q - distance / 2).norm(), 1e-15);
    EXPECT_LT((reference.qd - peak * distance / 2).norm(), 1e-15);
    EXPECT_LT(reference.qdd.norm(), 1e-15);
  }
}

TEST(Trajectory, StartsWithTheTextbookAcceleration) {
  const JointVector unit = reportTx().waypoints[1].q / 4.0;  // distance / duration^2
  for (const auto& [interpolation, factor] : {std::pair(Interpolation::kCubic, 6.0),
                                              {Interpolation::kQuintic, 0.0},
                                              {Interpolation::kTrapezoidal, 16.0 / 3.0}}) {
    const Trajectory trajectory(test::rppRobot(), {.motion = reportTx(interpolation)});
    EXPECT_LT((referenceAt(trajectory, 0.0).qdd - factor * unit).norm(), 1e-15);
  }
}

TEST(Trajectory, DerivativesAreThoseOfThePosition) {
  for (const Interpolation interpolation : kAll) {
    const Trajectory trajectory(test::rppRobot(), {.motion = reportTq(interpolation)});
    for (double t = 0.013; t < 3.2; t += 0.037) expectDerivatives(trajectory, t);
  }
}

TEST(Trajectory, TaskDerivativesHoldForAnyChain) {
  const RobotModel robot = test::randomChain(7, 3);
  std::mt19937 generator(4);
  const JointVector from = test::randomJointVector(generator, 7, 1.0), to = test::randomJointVector(generator, 7, 1.0);
  const Trajectory trajectory(robot, {.motion = JointPath{.waypoints = {{0.0, from}, {2.0, to}}}});
  for (double t = 0.1; t < 2.0; t += 0.1) expectDerivatives(trajectory, t, 1e-7);
}

TEST(Trajectory, IsContinuousAtWaypoints) {
  // Over 2e-9 s the position may move by 2e-9 times the speed, and so on up: the tolerances allow for slopes up to 100.
  constexpr double kGap = 1e-9;
  for (const Interpolation interpolation : kAll) {
    const Trajectory trajectory(test::rppRobot(), {.motion = reportTq(interpolation)});
    for (const double t : {0.0, 1.0, 2.0, 3.0}) {
      const Reference before = referenceAt(trajectory, t - kGap), after = referenceAt(trajectory, t + kGap);
      EXPECT_LT((after.q - before.q).norm(), 1e-7) << t;
      EXPECT_LT((after.qd - before.qd).norm(), 1e-7) << t;
      if (interpolation == Interpolation::kQuintic) {
        EXPECT_LT((after.qdd - before.qdd).norm(), 5e-7) << t;
      }
    }
  }
}

TEST(Trajectory, IsAPureFunctionOfTime) {
  const Trajectory trajectory(test::rppRobot(), {.motion = reportTq(Interpolation::kQuintic)});
  Reference reused;
  for (const double t : {2.9, 0.1, 5.0, 1.5, 0.1}) {
    trajectory.evaluate(t, reused);
    const Reference fresh = referenceAt(trajectory, t);
    EXPECT_EQ(reused.q, fresh.q);
    EXPECT_EQ(reused.qdd, fresh.qdd);
    EXPECT_EQ(reused.X_WE.p, fresh.X_WE.p);
    EXPECT_EQ(reused.A_WE, fresh.A_WE);
  }
}

TEST(Trajectory, EvaluatesWithoutAllocating) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer has its own malloc";
  const Trajectory trajectory(test::rppRobot(), {.motion = reportTq(Interpolation::kQuintic)});
  Reference reference;
  const test::AllocationGuard guard;
  for (double t = -1.0; t < 5.0; t += 0.01) trajectory.evaluate(t, reference);
  EXPECT_EQ(guard.count(), 0u);
}

std::string messageOf(const TrajectorySpec& spec) {
  try {
    const Trajectory trajectory(test::rppRobot(), spec);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

/// The message about a motion after a change that makes it wrong.
template <typename Motion, typename Change>
std::string messageAfter(Motion motion, const Change& change) {
  change(motion);
  return messageOf({.motion = motion});
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Trajectory, RefusesAPathItCannotFollow) {
  EXPECT_EQ(messageOf({}), "expected at least one waypoint, found none");
  EXPECT_EQ(messageAfter(reportTx(), [](JointPath& path) { path.waypoints[1].q = JointVector::Zero(2); }),
            "waypoint 2: expected 3 numbers, one per joint, found 2");
  EXPECT_EQ(messageAfter(reportTx(), [](JointPath& path) { path.waypoints[1].time_s = 0.0; }),
            "waypoint 2: expected a time after 0 s, found 0 s");
  EXPECT_EQ(messageAfter(reportTx(), [](JointPath& path) { path.waypoints[0].time_s = kNaN; }),
            "waypoint 1: expected a finite time");
  EXPECT_EQ(messageAfter(reportTx(), [](JointPath& path) { path.waypoints[0].q(1) = kNaN; }),
            "waypoint 1: expected finite numbers");
  EXPECT_EQ(messageAfter(reportTx(), [](JointPath& path) { path.timing.ramp = 0.6; }),
            "expected a ramp above 0 and up to 0.5, found 0.6");
  EXPECT_EQ(messageAfter(reportTx(), [](JointPath& path) { path.timing.ramp = 0.0; }),
            "expected a ramp above 0 and up to 0.5, found 0");
  EXPECT_EQ(messageOf({.motion = reportTx(), .h_d = Vector6::Constant(kNaN)}),
            "expected a desired wrench of finite numbers");
}

TEST(Trajectory, RefusesATipPathItCannotFollow) {
  const TipPath path{.waypoints = {{0.0, {}}}};
  EXPECT_EQ(messageOf({.motion = path}), "accepted");
  EXPECT_EQ(messageAfter(path, [](TipPath& tip) { tip.waypoints.clear(); }),
            "expected at least one waypoint, found none");
  EXPECT_EQ(messageAfter(path, [](TipPath& tip) { tip.waypoints[0].X_WE.p.x() = kNaN; }),
            "waypoint 1: expected finite numbers");
  EXPECT_EQ(messageAfter(path, [](TipPath& tip) { tip.waypoints[0].X_WE.R *= 1.1; }),
            "waypoint 1: expected a rotation matrix");
  EXPECT_EQ(messageAfter(path, [](TipPath& tip) { tip.waypoints[0].X_WE.R *= -1.0; }),
            "waypoint 1: expected a rotation matrix");
}

TEST(Trajectory, RefusesASineItCannotFollow) {
  const JointVector zero = Vector3::Zero();
  const JointSine sine{.offset = zero, .amplitude = zero, .frequency_rad_per_s = zero, .phase_rad = zero};
  EXPECT_EQ(messageOf({.motion = sine}), "accepted");
  EXPECT_EQ(messageAfter(sine, [](JointSine& bad) { bad.amplitude = JointVector::Zero(1); }),
            "amplitude: expected 3 numbers, one per joint, found 1");
  EXPECT_EQ(messageAfter(sine, [](JointSine& bad) { bad.phase_rad(2) = kNaN; }), "phase: expected finite numbers");
  EXPECT_EQ(messageAfter(sine, [](JointSine& bad) { bad.slow_down_s = 0.0; }),
            "expected a time to slow down above 0 s, found 0 s");
  EXPECT_EQ(messageAfter(sine, [](JointSine& bad) { bad.end_s = 0.5; }),
            "expected an end not before the time to slow down, 1 s, found 0.5 s");
  EXPECT_EQ(messageAfter(sine, [](JointSine& bad) { bad.end_s = kNaN; }),
            "expected an end not before the time to slow down, 1 s, found nan s");
}

TEST(Trajectory, RefusesNoiseItCannotMake) {
  const HoldNoise good{.hold_s = 0.1, .standard_deviation = Vector3(0.1, 0.02, 0.02)};
  const auto message_after = [&](const auto& change) {
    HoldNoise noise = good;
    change(noise);
    return messageOf({.motion = reportTx(), .noise = noise});
  };
  EXPECT_EQ(messageOf({.motion = reportTx(), .noise = good}), "accepted");
  EXPECT_EQ(message_after([](HoldNoise& noise) { noise.hold_s = 0.0; }),
            "noise: expected a hold of at least 1e-9 s, found 0 s");
  EXPECT_EQ(message_after([](HoldNoise& noise) { noise.standard_deviation(1) = -0.02; }),
            "noise: expected standard deviations of at least 0");
  EXPECT_EQ(message_after([](HoldNoise& noise) { noise.standard_deviation.resize(0); }),
            "noise: expected 3 numbers, one per joint, found 0");
  EXPECT_EQ(messageOf({.motion = TipPath{.waypoints = {{0.0, {}}}}, .noise = good}),
            "noise: expected a motion of joints, because noise is added to the joint reference, found one of the tip");
}

}  // namespace
}  // namespace baton
