#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "derivatives.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using test::expectDerivatives;
using test::referenceAt;

constexpr double kPi = 3.14159265358979323846;
constexpr auto kAll = {Interpolation::kCubic, Interpolation::kQuintic, Interpolation::kTrapezoidal};

Pose pose(const Vector3& p, double angle, const Vector3& axis) {
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), p};
}

/// Three poses; each turn is about an axis that is no axis of the world.
TipPath threePoses(Interpolation interpolation) {
  return {.timing = {.interpolation = interpolation},
          .waypoints = {{0.5, pose({0.5, -0.4, 0.4}, 0.3, {1, 2, 3})},
                        {2.0, pose({0.6, -0.7, 0.7}, 2.0, {-1, 2, 0.5})},
                        {3.0, pose({0.4, -0.5, 0.9}, 1.0, {0, -1, 1})}}};
}

TEST(TipPath, PassesEveryPoseAtRestAndHoldsBeforeAndAfter) {
  for (const Interpolation interpolation : kAll) {
    const TipPath path = threePoses(interpolation);
    const Trajectory trajectory(test::rppRobot(), {.motion = path});
    EXPECT_EQ(trajectory.endTime(), 3.0);
    for (const double t : {-1.0, 0.5, 2.0, 3.0, 9.0}) {
      const Reference reference = referenceAt(trajectory, t);
      const Pose& expected = path.waypoints[t < 1.0 ? 0 : t < 2.5 ? 1 : 2].X_WE;
      EXPECT_EQ(reference.X_WE.p, expected.p) << t;
      EXPECT_TRUE(reference.X_WE.R.isApprox(expected.R, 1e-15)) << t;
      EXPECT_TRUE(reference.V_WE.isZero(0.0)) << t;
      if (interpolation == Interpolation::kQuintic || t < 0.5 || t >= 3.0) {
        EXPECT_TRUE(reference.A_WE.isZero(0.0)) << t;
      }
    }
  }
}

TEST(TipPath, ArrivesAtThePoseItGoesTo) {
  constexpr double kGap = 1e-9;  // during which the tip moves and turns by less than 1e-8
  for (const Interpolation interpolation : kAll) {
    const TipPath path = threePoses(interpolation);
    const Trajectory trajectory(test::rppRobot(), {.motion = path});
    for (const auto& waypoint : path.waypoints) {
      const Reference before = referenceAt(trajectory, waypoint.time_s - kGap);
      EXPECT_LT((before.X_WE.p - waypoint.X_WE.p).norm(), 1e-8);
      EXPECT_LT((before.X_WE.R - waypoint.X_WE.R).norm(), 1e-8);
    }
  }
}

TEST(TipPath, MovesOnAStraightLineAndTurnsAboutAFixedAxis) {
  const TipPath path = threePoses(Interpolation::kQuintic);
  const Trajectory trajectory(test::rppRobot(), {.motion = path});
  const Pose &from = path.waypoints[0].X_WE, &to = path.waypoints[1].X_WE;
  const Vector3 direction = (to.p - from.p).normalized();
  const Matrix3 R_whole = to.R * from.R.transpose();
  const Vector3 turn = rotationVector(R_whole);
  for (double t = 0.6; t < 2.0; t += 0.1) {
    const Reference reference = referenceAt(trajectory, t);
    const Vector3 way = reference.X_WE.p - from.p, v = reference.V_WE.head<3>(), omega = reference.V_WE.tail<3>();
    EXPECT_LT(direction.cross(way).norm(), 1e-15) << t;
    EXPECT_LT(direction.cross(v).norm(), 1e-15) << t;
    EXPECT_LT(turn.cross(omega).norm(), 1e-14) << t;
    // Both parts are equally far along.
    const Matrix3 R_so_far = reference.X_WE.R * from.R.transpose();
    EXPECT_LT((rotationVector(R_so_far) / turn.norm() - way.norm() / (to.p - from.p).norm() * turn.normalized()).norm(),
              1e-14)
        << t;
    EXPECT_TRUE((reference.X_WE.R * reference.X_WE.R.transpose()).isIdentity(1e-14)) << t;
  }
}

TEST(TipPath, DerivativesAreThoseOfThePose) {
  for (const Interpolation interpolation : kAll) {
    const Trajectory trajectory(test::rppRobot(), {.motion = threePoses(interpolation)});
    for (double t = 0.013; t < 3.5; t += 0.037) expectDerivatives(trajectory, t);
  }
}

TEST(TipPath, TurnsHalfAWholeTurnToo) {
  const TipPath path{.waypoints = {{0.0, pose({0, 0, 0}, 0.0, {0, 0, 1})}, {1.0, pose({0, 0, 0}, kPi, {0, 0.6, 0.8})}}};
  const Trajectory trajectory(test::rppRobot(), {.motion = path});
  const Reference half_way = referenceAt(trajectory, 0.5);
  const Vector3 turned = rotationVector(half_way.X_WE.R);
  EXPECT_NEAR(turned.norm(), kPi / 2, 1e-14);
  EXPECT_LT(turned.cross(Vector3(0, 0.6, 0.8)).norm(), 1e-12);
  expectDerivatives(trajectory, 0.4);
}

TEST(TipPath, HasNoJointReferenceEvenInAReusedOne) {
  const Trajectory joints(test::rppRobot(), {.motion = JointPath{.waypoints = {{0.0, Vector3(0.1, 0.2, 0.3)}}}});
  const Trajectory tip(test::rppRobot(), {.motion = threePoses(Interpolation::kQuintic)});
  Reference reference;
  joints.evaluate(0.0, reference);
  tip.evaluate(1.0, reference);
  EXPECT_EQ(reference.q.size(), 0);
  EXPECT_EQ(reference.qd.size(), 0);
  EXPECT_EQ(reference.qdd.size(), 0);
  EXPECT_TRUE(reference.has_task);
}

TEST(TipPath, EvaluatesWithoutAllocating) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer has its own malloc";
  const Trajectory trajectory(test::rppRobot(), {.motion = threePoses(Interpolation::kTrapezoidal)});
  Reference reference;
  const test::AllocationGuard guard;
  for (double t = -1.0; t < 5.0; t += 0.01) trajectory.evaluate(t, reference);
  EXPECT_EQ(guard.count(), 0u);
}

}  // namespace
}  // namespace baton
