#include "environment/plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace baton {
namespace {

PlaneSpec reportWall(double stiffness_N_per_m) {
  return {.point_m = {0.0, 0.0, 0.7}, .normal = {0.0, 0.0, 1.0}, .stiffness_N_per_m = stiffness_N_per_m};
}

PlaneSpec obliqueWall() {
  return {.point_m = {0.2, -0.1, 0.3},
          .normal = {1.0, -2.0, 2.0},  // length 3
          .stiffness_N_per_m = 800.0,
          .damping_N_s_per_m = 15.0};
}

Vector3 randomVector(std::mt19937& generator, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  return {uniform(generator), uniform(generator), uniform(generator)};
}

TEST(Plane, ReportWallPushesUpInProportionToDepth) {
  const Contact contact = planeContact(reportWall(200.0), {0.5, -0.6, 0.725}, Vector3::Zero());
  EXPECT_NEAR(contact.penetration, 0.025, 1e-15);
  EXPECT_NEAR(contact.h_e(2), 5.0, 1e-12);
  EXPECT_EQ(contact.h_e(0), 0.0);
  EXPECT_EQ(contact.h_e(1), 0.0);
  EXPECT_TRUE(contact.h_e.tail<3>().isZero(0.0));
  EXPECT_EQ(contact.df_dp(2, 2), 200.0);
  EXPECT_TRUE(contact.df_dv.isZero(0.0));
}

TEST(Plane, GivesNothingOutOfContact) {
  PlaneSpec wall = reportWall(5000.0);
  wall.damping_N_s_per_m = 100.0;
  for (const double z : {0.0, 0.69999, 0.7}) {
    const Contact contact = planeContact(wall, {0.5, -0.6, z}, {0.0, 0.0, 3.0});
    EXPECT_TRUE(contact.h_e.isZero(0.0)) << z;
    EXPECT_TRUE(contact.df_dp.isZero(0.0)) << z;
    EXPECT_TRUE(contact.df_dv.isZero(0.0)) << z;
    EXPECT_EQ(contact.penetration, 0.0) << z;
  }
}

TEST(Plane, NeverPullsATipThatLeaves) {
  const PlaneSpec wall = obliqueWall();
  const Vector3 n = wall.normal.normalized();
  const double depth = 0.01;  // 8 N of spring, cut when 15 N s/m x speed is more
  const Vector3 p = wall.point_m + depth * n;
  EXPECT_GT(planeContact(wall, p, -0.5 * n).h_e.norm(), 0.0);
  const Contact leaving = planeContact(wall, p, -0.6 * n);
  EXPECT_TRUE(leaving.h_e.isZero(0.0));
  EXPECT_TRUE(leaving.df_dp.isZero(0.0));
  EXPECT_TRUE(leaving.df_dv.isZero(0.0));
  EXPECT_NEAR(leaving.penetration, depth, 1e-15);  // still touching
}

TEST(Plane, FeelsNoForceAlongItself) {
  const PlaneSpec wall = obliqueWall();
  const Vector3 n = wall.normal.normalized();
  std::mt19937 generator(1);
  for (int i = 0; i < 100; ++i) {
    const Vector3 along = n.cross(randomVector(generator, 2.0));
    const Contact still = planeContact(wall, wall.point_m + 0.02 * n, Vector3::Zero());
    const Contact slid = planeContact(wall, wall.point_m + 0.02 * n + along, n.cross(randomVector(generator, 2.0)));
    EXPECT_LT((still.h_e - slid.h_e).norm(), 1e-11);  // 16 N x a few roundings
    EXPECT_LT(n.cross(slid.h_e.head<3>()).norm(), 1e-11);
    EXPECT_LT((slid.df_dp * along).norm(), 1e-11);
  }
}

TEST(Plane, DoesNotDependOnTheLengthOfItsNormal) {
  PlaneSpec wall = obliqueWall();
  const Vector3 p = wall.point_m + Vector3(0.1, -0.1, 0.1);
  const Contact one = planeContact(wall, p, {0.1, 0.0, 0.0});
  wall.normal *= 7.0;
  const Contact seven = planeContact(wall, p, {0.1, 0.0, 0.0});
  EXPECT_LT((one.h_e - seven.h_e).norm(), 1e-12 * one.h_e.norm());
}

TEST(Plane, DerivativesAreThoseOfTheForce) {
  // The force is linear in contact, so central differences are exact but for rounding: 1e-13 N / 1e-4.
  const PlaneSpec wall = obliqueWall();
  const Vector3 n = wall.normal.normalized();
  constexpr double kStep = 1e-4;
  std::mt19937 generator(2);
  for (int i = 0; i < 50; ++i) {
    const Vector3 p = wall.point_m + 0.05 * n + n.cross(randomVector(generator, 1.0));
    const Vector3 v = randomVector(generator, 0.1);
    const Contact contact = planeContact(wall, p, v);
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 d = kStep * Vector3::Unit(axis);
      const Vector3 by_p =
          (planeContact(wall, p + d, v).h_e - planeContact(wall, p - d, v).h_e).head<3>() / (2 * kStep);
      const Vector3 by_v =
          (planeContact(wall, p, v + d).h_e - planeContact(wall, p, v - d).h_e).head<3>() / (2 * kStep);
      EXPECT_LT((by_p - contact.df_dp.col(axis)).norm(), 1e-8);
      EXPECT_LT((by_v - contact.df_dv.col(axis)).norm(), 1e-8);
    }
  }
}

TEST(Plane, DampingTakesEnergyOverACycleAndTheSpringTakesNone) {
  // Tip depth 0.02 + 0.01 sin t along the normal: the work the tip does on the wall over a cycle is pi D A^2.
  for (const double damping : {0.0, 15.0}) {
    PlaneSpec wall = obliqueWall();
    wall.damping_N_s_per_m = damping;
    const Vector3 n = wall.normal.normalized();
    constexpr double kPi = 3.14159265358979323846;
    constexpr int kSteps = 1000;
    double work = 0.0;  // the trapezium rule on a period is exact for these sines
    for (int k = 0; k < kSteps; ++k) {
      const double t = 2.0 * kPi * k / kSteps;
      const Vector3 v = 0.01 * std::cos(t) * n;
      const Contact contact = planeContact(wall, wall.point_m + (0.02 + 0.01 * std::sin(t)) * n, v);
      work += contact.h_e.head<3>().dot(v) * 2.0 * kPi / kSteps;
    }
    EXPECT_NEAR(work, kPi * damping * 1e-4, 1e-12);
  }
}

}  // namespace
}  // namespace baton
