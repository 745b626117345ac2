#include "environment/plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "base/error.hpp"

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

/// Derivatives against central differences. The force is linear where it is smooth, so these are exact but for
/// rounding: 1e-13 N / 1e-4.
template <typename ContactAt>
void expectDerivatives(const ContactAt& contact_at, const Vector3& p, const Vector3& v) {
  constexpr double kStep = 1e-4;
  const Contact contact = contact_at(p, v);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 d = kStep * Vector3::Unit(axis);
    const Vector3 by_p = (contact_at(p + d, v).h_e - contact_at(p - d, v).h_e).template head<3>() / (2 * kStep);
    const Vector3 by_v = (contact_at(p, v + d).h_e - contact_at(p, v - d).h_e).template head<3>() / (2 * kStep);
    EXPECT_LT((by_p - contact.df_dp.col(axis)).norm(), 1e-8);
    EXPECT_LT((by_v - contact.df_dv.col(axis)).norm(), 1e-8);
  }
}

TEST(Plane, DerivativesAreThoseOfTheForce) {
  const PlaneSpec wall = obliqueWall();
  const Vector3 n = wall.normal.normalized();
  std::mt19937 generator(2);
  for (int i = 0; i < 50; ++i) {
    for (const double depth : {0.05, -0.05}) {  // inside, outside
      const Vector3 p = wall.point_m + depth * n + n.cross(randomVector(generator, 1.0));
      expectDerivatives([&](const auto& at, const auto& v) { return planeContact(wall, at, v); }, p,
                        randomVector(generator, 0.1));
    }
  }
}

TEST(Plane, HoldsTheTipFromBothSidesUnlessUnilateral) {
  PlaneSpec spring = obliqueWall();
  spring.unilateral = false;
  const Vector3 n = spring.normal.normalized();
  std::mt19937 generator(3);
  for (const double depth : {-0.3, -0.01, 0.01, 0.3}) {
    const Vector3 p = spring.point_m + depth * n + n.cross(randomVector(generator, 1.0));
    const Contact still = planeContact(spring, p, Vector3::Zero());
    EXPECT_LT((still.h_e.head<3>() - 800.0 * depth * n).norm(), 1e-11) << depth;
    EXPECT_NEAR(still.penetration, std::abs(depth), 1e-15) << depth;
    const Contact leaving = planeContact(spring, p, -10.0 * n);  // damping wins over the spring: it pulls
    EXPECT_LT((leaving.h_e.head<3>() - (800.0 * depth - 150.0) * n).norm(), 1e-11) << depth;
    expectDerivatives([&](const auto& at, const auto& v) { return planeContact(spring, at, v); }, p,
                      randomVector(generator, 1.0));
  }
}

TEST(Plane, SpringFromBothSidesIsAWallWhereThatPushes) {
  PlaneSpec spring = obliqueWall();
  spring.unilateral = false;
  const Vector3 n = spring.normal.normalized();
  const Vector3 p = spring.point_m + 0.05 * n, v(0.1, -0.1, 0.05);
  const Contact two_sided = planeContact(spring, p, v), one_sided = planeContact(obliqueWall(), p, v);
  EXPECT_EQ(two_sided.h_e, one_sided.h_e);
  EXPECT_EQ(two_sided.df_dp, one_sided.df_dp);
  EXPECT_EQ(two_sided.df_dv, one_sided.df_dv);
  EXPECT_EQ(two_sided.penetration, one_sided.penetration);
}

/// The report's wall, an oblique one and a spring, all of which a tip at (0.5, -0.6, 0.72) touches.
std::vector<PlaneSpec> threePlanes() {
  return {
      reportWall(200.0),
      {.point_m = {0.4, -0.5, 0.6}, .normal = {1.0, -1.0, 0.5}, .stiffness_N_per_m = 500.0, .damping_N_s_per_m = 8.0},
      {.point_m = {0.9, 0.0, 0.0}, .normal = {1.0, 0.0, 0.0}, .stiffness_N_per_m = 90.0, .unilateral = false}};
}

TEST(Planes, AddUpForcesAndDerivatives) {
  const Vector3 p(0.5, -0.6, 0.72), v(0.1, 0.2, -0.1);
  const std::vector<PlaneSpec> planes = threePlanes();
  Contact sum;
  for (const PlaneSpec& plane : planes) {
    const Contact one = planeContact(plane, p, v);
    EXPECT_GT(one.penetration, 0.0);
    sum.h_e += one.h_e;
    sum.df_dp += one.df_dp;
    sum.df_dv += one.df_dv;
  }
  const Contact all = planesContact(planes, p, v);
  EXPECT_EQ(all.h_e, sum.h_e);
  EXPECT_EQ(all.df_dp, sum.df_dp);
  EXPECT_EQ(all.df_dv, sum.df_dv);
  EXPECT_NEAR(all.penetration, 0.4, 1e-15);  // the spring's
  expectDerivatives([&](const auto& at, const auto& speed) { return planesContact(planes, at, speed); }, p, v);
}

TEST(Planes, ThatAreNotTouchedOrNotThereGiveNothing) {
  EXPECT_TRUE(planesContact({}, {0, 0, 1}, {0, 0, 1}).h_e.isZero(0.0));
  const std::vector<PlaneSpec> walls{reportWall(200.0), obliqueWall()};
  const Contact contact = planesContact(walls, {-1.0, 1.0, -1.0}, {0, 0, 1});
  EXPECT_TRUE(contact.h_e.isZero(0.0));
  EXPECT_TRUE(contact.df_dp.isZero(0.0));
  EXPECT_EQ(contact.penetration, 0.0);
}

TEST(Planes, TakeForceOnlyAlongTheirNormals) {
  // The report's Figure 51: a wall normal to z cannot be pressed with (0, 1, 3) N, wherever the tip goes; with a wall
  // normal to y beside it, it can.
  const Vector3 f_d(0.0, 1.0, 3.0), p(0.5, 0.02, 0.72);
  const auto nearest = [&](const std::vector<PlaneSpec>& planes) -> Vector3 {
    const Contact here = planesContact(planes, p, Vector3::Zero());
    const Vector3 missing = f_d - here.h_e.head<3>();
    const Vector3 move = here.df_dp.fullPivLu().solve(missing);
    return planesContact(planes, p + move, Vector3::Zero()).h_e.head<3>();
  };
  const PlaneSpec side{.point_m = Vector3::Zero(), .normal = {0.0, 1.0, 0.0}, .stiffness_N_per_m = 100.0};
  EXPECT_LT((nearest({reportWall(100.0)}) - Vector3(0.0, 0.0, 3.0)).norm(), 1e-12);
  EXPECT_LT((nearest({reportWall(100.0), side}) - f_d).norm(), 1e-12);
}

std::string messageAfter(void (*change)(PlaneSpec&)) {
  PlaneSpec plane = reportWall(200.0);
  change(plane);
  try {
    checkPlane(plane);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CheckPlane, RefusesWhatIsNoPlane) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(messageAfter([](PlaneSpec&) {}), "accepted");
  EXPECT_EQ(messageAfter([](PlaneSpec& plane) { plane.stiffness_N_per_m = 0.0; }), "accepted");
  EXPECT_EQ(messageAfter([](PlaneSpec& plane) { plane.point_m.x() = kNaN; }), "point: expected finite numbers");
  EXPECT_EQ(messageAfter([](PlaneSpec& plane) { plane.normal.x() = kNaN; }), "normal: expected finite numbers");
  EXPECT_EQ(messageAfter([](PlaneSpec& plane) { plane.normal.setZero(); }),
            "normal: expected a direction, found a vector of length 0");
  EXPECT_EQ(messageAfter([](PlaneSpec& plane) { plane.stiffness_N_per_m = -1.0; }),
            "stiffness: expected a finite number of at least 0, found -1");
  EXPECT_EQ(messageAfter([](PlaneSpec& plane) { plane.damping_N_s_per_m = kNaN; }),
            "damping: expected a finite number of at least 0, found nan");
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
