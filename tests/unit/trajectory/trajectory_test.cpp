#include "trajectory/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.hpp"
#include "robot/kinematics.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr auto kBoth = {Interpolation::kCubic, Interpolation::kQuintic};

Waypoint at(double time_s, double q1, double q2, double q3) { return {time_s, Vector3(q1, q2, q3)}; }

TrajectorySpec reportTq(Interpolation interpolation) {
  return {
      .interpolation = interpolation,
      .waypoints = {at(0, 0, 0, 0), at(1, kPi / 4, 0.2, 0.05), at(2, -kPi / 6, 0.05, 0.2), at(3, kPi / 3, 0.1, 0.1)}};
}

TrajectorySpec reportTx() {
  return {.waypoints = {at(0, 0, 0, 0), at(2, kPi / 6, 0.2, 0.1)}, .h_d = (Vector6() << 0, 0, 3, 0, 0, 0).finished()};
}

Reference evaluate(const Trajectory& trajectory, double time_s) {
  Reference reference;
  trajectory.evaluate(time_s, reference);
  return reference;
}

TEST(Trajectory, PassesEveryWaypointAtRest) {
  for (const Interpolation interpolation : kBoth) {
    const TrajectorySpec spec = reportTq(interpolation);
    const Trajectory trajectory(test::rppRobot(), spec);
    for (const Waypoint& waypoint : spec.waypoints) {
      const Reference reference = evaluate(trajectory, waypoint.time_s);
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
  TrajectorySpec spec = reportTq(Interpolation::kCubic);
  for (Waypoint& waypoint : spec.waypoints) waypoint.time_s += 1.5;
  const Trajectory trajectory(test::rppRobot(), spec);
  for (const double t : {-1.0, 0.0, 1.499, 4.5, 4.501, 1e9}) {
    const Reference reference = evaluate(trajectory, t);
    EXPECT_EQ(reference.q, t < 2.0 ? spec.waypoints.front().q : spec.waypoints.back().q) << t;
    EXPECT_TRUE(reference.qd.isZero(0.0) && reference.qdd.isZero(0.0)) << t;
    EXPECT_TRUE(reference.V_WE.isZero(0.0) && reference.A_WE.isZero(0.0)) << t;
  }
}

TEST(Trajectory, OneWaypointIsASetPoint) {
  const RobotModel robot = test::rppRobot();
  const Trajectory trajectory(robot, {.waypoints = {at(0, kPi / 3, 0.1, 0.1)}});
  for (const double t : {-1.0, 0.0, 7.0}) {
    const Reference reference = evaluate(trajectory, t);
    EXPECT_EQ(reference.q, Vector3(kPi / 3, 0.1, 0.1));
    EXPECT_TRUE(reference.qd.isZero(0.0) && reference.qdd.isZero(0.0));
    EXPECT_TRUE(reference.has_task);
    EXPECT_NEAR((reference.X_WE.p - Vector3(0.3250, -0.5600, 0.9629)).norm(), 0.0, 1e-4);  // the report's four digits
  }
}

TEST(Trajectory, TxEndsAtTheReportsTaskPointAndCarriesTheWrench) {
  const Trajectory trajectory(test::rppRobot(), reportTx());
  for (const double t : {2.0, 8.0}) {
    const Reference reference = evaluate(trajectory, t);
    EXPECT_NEAR((reference.X_WE.p - Vector3(0.5629, -0.66, 0.725)).norm(), 0.0, 1e-4);
    EXPECT_EQ(reference.h_d(2), 3.0);
  }
}

TEST(Trajectory, HalfWayIsTheMiddleAtTheTextbookPeakSpeed) {
  // Peak speed over mean speed: 3/2 for the cubic, 15/8 for the quintic; both have no acceleration there.
  for (const Interpolation interpolation : kBoth) {
    TrajectorySpec spec = reportTx();
    spec.interpolation = interpolation;
    const Reference reference = evaluate(Trajectory(test::rppRobot(), spec), 1.0);
    const JointVector distance = spec.waypoints[1].q;
    const double peak = interpolation == Interpolation::kCubic ? 1.5 : 1.875;
    EXPECT_LT((reference.q - distance / 2).norm(), 1e-15);
    EXPECT_LT((reference.qd - peak * distance / 2).norm(), 1e-15);
    EXPECT_LT(reference.qdd.norm(), 1e-15);
  }
}

TEST(Trajectory, CubicStartsWithItsLargestAcceleration) {
  TrajectorySpec spec = reportTx();
  spec.interpolation = Interpolation::kCubic;
  const Reference reference = evaluate(Trajectory(test::rppRobot(), spec), 0.0);
  const JointVector expected = 6.0 / 4.0 * spec.waypoints[1].q;  // 6 distance / duration^2
  EXPECT_LT((reference.qdd - expected).norm(), 1e-15);
}

TEST(Trajectory, DerivativesAreThoseOfThePosition) {
  // Central differences are off by h^2/6 times the third derivative, here below 1000, plus rounding of 1e-15/h.
  constexpr double h = 1e-5;
  constexpr double kTolerance = 2e-8;
  for (const Interpolation interpolation : kBoth) {
    const Trajectory trajectory(test::rppRobot(), reportTq(interpolation));
    for (double t = 0.013; t < 3.2; t += 0.037) {
      const Reference now = evaluate(trajectory, t), before = evaluate(trajectory, t - h),
                      after = evaluate(trajectory, t + h);
      EXPECT_LT(((after.q - before.q) / (2 * h) - now.qd).norm(), kTolerance) << t;
      EXPECT_LT(((after.qd - before.qd) / (2 * h) - now.qdd).norm(), kTolerance) << t;
      EXPECT_LT(((after.X_WE.p - before.X_WE.p) / (2 * h) - now.V_WE.head<3>()).norm(), kTolerance) << t;
      const Vector3 turned = rotationVector(after.X_WE.R * before.X_WE.R.transpose());
      EXPECT_LT((turned / (2 * h) - now.V_WE.tail<3>()).norm(), kTolerance) << t;
      EXPECT_LT(((after.V_WE - before.V_WE) / (2 * h) - now.A_WE).norm(), kTolerance) << t;
    }
  }
}

TEST(Trajectory, TaskDerivativesHoldForAnyChain) {
  constexpr double h = 1e-5;
  const RobotModel robot = test::randomChain(7, 3);
  std::mt19937 generator(4);
  const JointVector from = test::randomJointVector(generator, 7, 1.0), to = test::randomJointVector(generator, 7, 1.0);
  const Trajectory trajectory(robot, {.waypoints = {{0.0, from}, {2.0, to}}});
  for (double t = 0.1; t < 2.0; t += 0.1) {
    const Reference now = evaluate(trajectory, t), before = evaluate(trajectory, t - h),
                    after = evaluate(trajectory, t + h);
    EXPECT_LT(((after.X_WE.p - before.X_WE.p) / (2 * h) - now.V_WE.head<3>()).norm(), 1e-7) << t;
    EXPECT_LT(((after.V_WE - before.V_WE) / (2 * h) - now.A_WE).norm(), 1e-7) << t;
  }
}

TEST(Trajectory, IsContinuousAtWaypoints) {
  // Over 2e-9 s the position may move by 2e-9 times the speed, and so on up: the tolerances allow for slopes up to 100.
  constexpr double kGap = 1e-9;
  for (const Interpolation interpolation : kBoth) {
    const Trajectory trajectory(test::rppRobot(), reportTq(interpolation));
    for (const double t : {0.0, 1.0, 2.0, 3.0}) {
      const Reference before = evaluate(trajectory, t - kGap), after = evaluate(trajectory, t + kGap);
      EXPECT_LT((after.q - before.q).norm(), 1e-7) << t;
      EXPECT_LT((after.qd - before.qd).norm(), 1e-7) << t;
      if (interpolation == Interpolation::kQuintic) {
        EXPECT_LT((after.qdd - before.qdd).norm(), 5e-7) << t;
      }
    }
  }
}

TEST(Trajectory, IsAPureFunctionOfTime) {
  const Trajectory trajectory(test::rppRobot(), reportTq(Interpolation::kQuintic));
  Reference reused;
  for (const double t : {2.9, 0.1, 5.0, 1.5, 0.1}) {
    trajectory.evaluate(t, reused);
    const Reference fresh = evaluate(trajectory, t);
    EXPECT_EQ(reused.q, fresh.q);
    EXPECT_EQ(reused.qdd, fresh.qdd);
    EXPECT_EQ(reused.X_WE.p, fresh.X_WE.p);
    EXPECT_EQ(reused.A_WE, fresh.A_WE);
  }
}

TEST(Trajectory, EvaluatesWithoutAllocating) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer has its own malloc";
  const Trajectory trajectory(test::rppRobot(), reportTq(Interpolation::kQuintic));
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

TEST(Trajectory, RefusesWhatItCannotFollow) {
  EXPECT_EQ(messageOf({}), "trajectory: expected at least one waypoint, found none");

  TrajectorySpec spec = reportTx();
  spec.waypoints[1].q = JointVector::Zero(2);
  EXPECT_EQ(messageOf(spec), "trajectory, waypoint 2: expected 3 joint positions, found 2");

  spec = reportTx();
  spec.waypoints[1].time_s = 0.0;
  EXPECT_EQ(messageOf(spec), "trajectory, waypoint 2: expected a time after 0 s, found 0 s");

  spec = reportTx();
  spec.waypoints[0].q(1) = std::nan("");
  EXPECT_EQ(messageOf(spec), "trajectory, waypoint 1: expected finite numbers");

  spec = reportTx();
  spec.h_d(0) = std::nan("");
  EXPECT_EQ(messageOf(spec), "trajectory: expected a desired wrench of finite numbers");
}

}  // namespace
}  // namespace baton
