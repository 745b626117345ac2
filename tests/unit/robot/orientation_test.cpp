/// ZYZ angles and the rotation vector.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "robot/kinematics.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;

Matrix3 rotationFromZyz(const Vector3& zyz) {
  return (Eigen::AngleAxisd(zyz(0), Vector3::UnitZ()) * Eigen::AngleAxisd(zyz(1), Vector3::UnitY()) *
          Eigen::AngleAxisd(zyz(2), Vector3::UnitZ()))
      .toRotationMatrix();
}

Vector3 rppZyz(double q1, double q2 = 0.1, double q3 = 0.1) {
  return zyzFromRotation(tipPose(test::rppRobot(), Vector3(q1, q2, q3)).R);
}

TEST(ZyzAngles, ReturnToTheRotationTheyCameFrom) {
  std::mt19937 generator(1);
  for (int k = 0; k < 500; ++k) {
    const Vector3 zyz(test::uniform(generator, -kPi, kPi), test::uniform(generator, 0.01, kPi - 0.01),
                      test::uniform(generator, -kPi, kPi));
    EXPECT_LT((zyzFromRotation(rotationFromZyz(zyz)) - zyz).norm(), 1e-12);  // rounding over sin(theta) >= 0.01
  }
}

TEST(ZyzAngles, OfTheRppAreThoseOfTheReport) {
  for (const double q1 : {-1.5, -0.3, 0.0, kPi / 3, 1.5}) {
    EXPECT_LT((rppZyz(q1) - Vector3(0.0, kPi / 2 - q1, kPi / 2)).norm(), 1e-12) << q1;
  }
  for (const double q1 : {1.6, 2.0, 3.0, 4.0, 4.7}) {
    EXPECT_LT((rppZyz(q1) - Vector3(kPi, q1 - kPi / 2, -kPi / 2)).norm(), 1e-12) << q1;
  }
}

TEST(ZyzAngles, DoNotFlipBetweenPiAndMinusPiByRounding) {
  std::mt19937 generator(2);
  for (int k = 0; k < 1000; ++k) {
    const double q1 = test::uniform(generator, kPi / 2 + 1e-3, 3 * kPi / 2 - 1e-3);
    const double angle = rppZyz(q1, test::uniform(generator, -1.0, 1.0), test::uniform(generator, -1.0, 1.0))(0);
    EXPECT_NEAR(angle, kPi, 1e-9);
  }
  for (const double noise : {-1e-15, -0.0, 0.0, 1e-15}) {
    Matrix3 R = rotationFromZyz(Vector3(kPi, 1.0, 0.5));
    R(1, 2) = noise;
    EXPECT_NEAR(zyzFromRotation(R)(0), kPi, 1e-12) << noise;
  }
}

TEST(ZyzAngles, AtASingularThetaGiveTheRotationWithPhiZero) {
  for (const double theta : {0.0, kPi}) {
    const Matrix3 R = rotationFromZyz(Vector3(0.4, theta, 0.3));
    const Vector3 zyz = zyzFromRotation(R);
    EXPECT_EQ(zyz(0), 0.0);
    EXPECT_NEAR(zyz(1), theta, 1e-12);
    EXPECT_NEAR(zyz(2), theta == 0.0 ? 0.7 : -0.1, 1e-12);
    EXPECT_LT((rotationFromZyz(zyz) - R).norm(), 1e-12);
  }
}

TEST(ZyzRateMatrix, MapsAngleRatesToAngularVelocity) {
  std::mt19937 generator(3);
  for (int k = 0; k < 100; ++k) {
    const Vector3 zyz(test::uniform(generator, -3.0, 3.0), test::uniform(generator, 0.1, 3.0),
                      test::uniform(generator, -3.0, 3.0));
    const Vector3 rates = test::randomJointVector(generator, 3, 1.0);
    const double h = 1e-6;
    const Matrix3 R = rotationFromZyz(zyz);
    const Matrix3 R_dot = (rotationFromZyz(zyz + h * rates) - rotationFromZyz(zyz - h * rates)) / (2 * h);
    const Matrix3 S = R_dot * R.transpose();  // the cross-product matrix of omega
    const Vector3 omega(S(2, 1), S(0, 2), S(1, 0));
    EXPECT_LT((zyzRateMatrix(zyz) * rates - omega).norm(), 1e-8);  // central difference: h^2 and epsilon / h
  }
}

TEST(ZyzRateMatrix, HasDeterminantMinusSineOfTheta) {
  EXPECT_NEAR(zyzRateMatrix(Vector3(0.3, 0.7, 0.2)).determinant(), -std::sin(0.7), 1e-15);
  EXPECT_EQ(zyzRateMatrix(Vector3(0.3, 0.0, 0.2)).determinant(), 0.0);
}

TEST(RotationVector, IsAxisTimesAngle) {
  std::mt19937 generator(4);
  for (int k = 0; k < 500; ++k) {
    const Vector3 axis = Vector3(test::randomJointVector(generator, 3, 1.0)).normalized();
    const double angle = test::uniform(generator, 0.0, kPi);
    const Matrix3 R = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LT((rotationVector(R) - angle * axis).norm(), 1e-12);
  }
}

TEST(RotationVector, IsAccurateNearZero) {
  EXPECT_EQ(rotationVector(Matrix3::Identity()), Vector3::Zero());
  for (const double angle : {1e-16, 1e-12, 1e-9, 1e-6, 1e-3}) {
    const Vector3 vector = angle * Vector3(1.0, 2.0, -2.0) / 3.0;
    const Matrix3 R = Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
    EXPECT_LT((rotationVector(R) - vector).norm(), 1e-12 * angle + 1e-16) << angle;
  }
}

TEST(RotationVector, IsAccurateNearPiAndShorterThanPiBeyond) {
  const Vector3 axis = Vector3(1.0, 2.0, -2.0) / 3.0;
  for (const double gap : {1e-12, 1e-9, 1e-6, 1e-3}) {
    const Matrix3 before = Eigen::AngleAxisd(kPi - gap, axis).toRotationMatrix();
    EXPECT_LT((rotationVector(before) - (kPi - gap) * axis).norm(), 1e-14) << gap;
    const Matrix3 beyond = Eigen::AngleAxisd(kPi + gap, axis).toRotationMatrix();
    EXPECT_LT((rotationVector(beyond) + (kPi - gap) * axis).norm(), 1e-14) << gap;
  }
  const Matrix3 half_turn = Eigen::AngleAxisd(kPi, axis).toRotationMatrix();  // either sign of the axis is right
  EXPECT_NEAR(rotationVector(half_turn).norm(), kPi, 1e-14);
  EXPECT_NEAR(std::abs(rotationVector(half_turn).dot(axis)), kPi, 1e-14);
}

}  // namespace
}  // namespace baton
