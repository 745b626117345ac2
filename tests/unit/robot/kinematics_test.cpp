#include "robot/kinematics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "support/robots.hpp"
#include "support/rpp_closed_form.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kPrinted = 5e-5;  // half a unit of the report's last digit
constexpr double kStep = 1e-5;     // of a central difference: truncation and rounding both leave about 1e-10
constexpr double kDifference = 1e-8;

const Vector3 kReportQ(kPi / 3, 0.1, 0.1);

Kinematics kinematicsAt(const RobotModel& model, const JointVector& q, const JointVector& qd) {
  Kinematics result;
  computeKinematics(model, q, qd, result);
  return result;
}

/// d/dt of the pose along qd by central difference, as a twist.
Vector6 twistByDifference(const RobotModel& model, const JointVector& q, const JointVector& qd) {
  const Pose before = tipPose(model, q - kStep * qd), after = tipPose(model, q + kStep * qd);
  const Matrix3 S = (after.R - before.R) / (2 * kStep) * tipPose(model, q).R.transpose();
  Vector6 twist;
  twist << (after.p - before.p) / (2 * kStep), S(2, 1), S(0, 2), S(1, 0);
  return twist;
}

/// Homogeneous transform of one row, written out from eq. 2.52.
Eigen::Matrix4d dhMatrix(double a, double alpha, double theta, double d) {
  const double ct = std::cos(theta), st = std::sin(theta), ca = std::cos(alpha), sa = std::sin(alpha);
  Eigen::Matrix4d A;
  A << ct, -st * ca, st * sa, a * ct,  //
      st, ct * ca, -ct * sa, a * st,   //
      0.0, sa, ca, d,                  //
      0.0, 0.0, 0.0, 1.0;
  return A;
}

TEST(TipPose, GivesTheDigitsOfTheReport) {
  const Pose X_WE = tipPose(test::rppRobot(), kReportQ);
  EXPECT_LT((X_WE.p - Vector3(0.3250, -0.5600, 0.9629)).cwiseAbs().maxCoeff(), kPrinted);
  Matrix3 R;
  R << 0.0, -0.8660, 0.5000,  //
      1.0, 0.0, 0.0,          //
      0.0, 0.5000, 0.8660;
  EXPECT_LT((X_WE.R - R).cwiseAbs().maxCoeff(), kPrinted);
  EXPECT_LT((test::rpp::inverseKinematics(X_WE.p) - kReportQ).norm(), 1e-14);

  const Vector3 x_d = tipPose(test::rppRobot(), Vector3(kPi / 6, 0.2, 0.1)).p;
  EXPECT_LT((x_d - Vector3(0.5629, -0.66, 0.725)).cwiseAbs().maxCoeff(), kPrinted);
}

TEST(TipPose, OfTheMisprintedAlphaIsInTheSamePlaceWithAnotherOrientation) {
  // In distal DH the last alpha turns the tip's frame about its own x axis: the printed position says nothing of it,
  // the printed orientation decides.
  RobotModel misprinted = test::rppRobot();
  misprinted.joints[2].dh.alpha_rad = kPi / 2;
  const Pose right = tipPose(test::rppRobot(), kReportQ), wrong = tipPose(misprinted, kReportQ);
  EXPECT_LT((wrong.p - right.p).norm(), 1e-15);
  Matrix3 R;
  R << 0.0, 0.5000, 0.8660,  //
      1.0, 0.0, 0.0,         //
      0.0, 0.8660, -0.5000;
  EXPECT_LT((wrong.R - R).cwiseAbs().maxCoeff(), kPrinted);
  EXPECT_GT((wrong.R - right.R).norm(), 1.0);
}

TEST(TipPose, OfTheRppIsItsClosedForm) {
  const RobotModel robot = test::rppRobot();
  std::mt19937 generator(1);
  for (int k = 0; k < 200; ++k) {
    const Vector3 q = test::randomJointVector(generator, 3, 3.0);
    const Pose actual = tipPose(robot, q), expected = test::rpp::tipPose(q);
    EXPECT_LT((actual.p - expected.p).norm(), 1e-14);
    EXPECT_LT((actual.R - expected.R).norm(), 1e-14);
    if (test::rpp::reach(q) > 0.0 && std::abs(q(0)) < kPi) {
      EXPECT_LT((test::rpp::inverseKinematics(actual.p) - q).norm(), 1e-12);
    }
  }
}

TEST(TipPose, IsTheProductOfDhMatrices) {
  std::mt19937 generator(2);
  for (int n = 1; n <= kMaxJoints; ++n) {
    const RobotModel model = test::randomChain(n, n);
    const JointVector q = test::randomJointVector(generator, n, 3.0);
    Eigen::Matrix4d T = dhMatrix(model.base.a_m, model.base.alpha_rad, model.base.theta_rad, model.base.d_m);
    for (int i = 0; i < n; ++i) {
      const DhRow& row = model.joints[i].dh;
      const bool turns = model.joints[i].kind == JointKind::kRevolute;
      T *= dhMatrix(row.a_m, row.alpha_rad, row.theta_rad + (turns ? q(i) : 0.0), row.d_m + (turns ? 0.0 : q(i)));
    }
    const Pose X_WE = tipPose(model, q);
    EXPECT_LT((X_WE.R - T.topLeftCorner<3, 3>()).norm(), 1e-14);
    EXPECT_LT((X_WE.p - T.topRightCorner<3, 1>()).norm(), 1e-14);

    const Kinematics kinematics = kinematicsAt(model, q, q);
    EXPECT_EQ(kinematics.X_WE.R, X_WE.R);  // both functions, the same bits
    EXPECT_EQ(kinematics.X_WE.p, X_WE.p);
    EXPECT_EQ(kinematics.X_WL[n].p, X_WE.p);
  }
}

TEST(GeometricJacobian, IsTheDerivativeOfThePose) {
  std::mt19937 generator(3);
  for (int n = 1; n <= kMaxJoints; ++n) {
    const RobotModel model = test::randomChain(n, 10 + n);
    const JointVector q = test::randomJointVector(generator, n, 3.0);
    const JointVector qd = test::randomJointVector(generator, n, 1.0);
    const Kinematics kinematics = kinematicsAt(model, q, qd);
    EXPECT_LT((kinematics.J * qd - kinematics.V_WE).norm(), 1e-13);
    for (int i = 0; i < n; ++i) {
      const Vector6 column = twistByDifference(model, q, JointVector::Unit(n, i));
      EXPECT_LT((kinematics.J.col(i) - column).norm(), kDifference) << n << " " << i;
    }
  }
}

TEST(GeometricJacobian, OfTheRppHasTheReachAsDeterminant) {
  const RobotModel robot = test::rppRobot();
  std::mt19937 generator(4);
  for (int k = 0; k < 100; ++k) {
    const Vector3 q = test::randomJointVector(generator, 3, 2.0);
    const Matrix3 J_P = kinematicsAt(robot, q, Vector3::Zero()).J.topRows<3>();
    EXPECT_LT((J_P - test::rpp::positionJacobian(q)).norm(), 1e-14);
    EXPECT_NEAR(J_P.determinant(), test::rpp::reach(q), 1e-14);
  }
}

TEST(JdotQd, IsTheTipsAccelerationWithoutJointAcceleration) {
  std::mt19937 generator(5);
  for (int n = 1; n <= kMaxJoints; ++n) {
    const RobotModel model = test::randomChain(n, 20 + n);
    const JointVector q = test::randomJointVector(generator, n, 3.0);
    const JointVector qd = test::randomJointVector(generator, n, 1.0);
    const Kinematics before = kinematicsAt(model, q - kStep * qd, qd), after = kinematicsAt(model, q + kStep * qd, qd);
    const Vector6 expected = (after.J - before.J) / (2 * kStep) * qd;
    EXPECT_LT((kinematicsAt(model, q, qd).Jdot_qd - expected).norm(), 10 * kDifference) << n;
  }
}

TEST(AnalyticalJacobian, IsTheDerivativeOfPositionAndZyzAngles) {
  std::mt19937 generator(6);
  int tested = 0;
  for (int k = 0; k < 200; ++k) {
    const int n = 1 + k % kMaxJoints;
    const RobotModel model = test::randomChain(n, k);
    const JointVector q = test::randomJointVector(generator, n, 3.0);
    const Kinematics kinematics = kinematicsAt(model, q, q);
    const Vector3 zyz = zyzFromRotation(kinematics.X_WE.R);
    // Away from the singularity and from the cuts at pi, where a difference quotient says nothing.
    if (std::sin(zyz(1)) < 0.1 || std::abs(zyz(0)) > 3.1 || std::abs(zyz(2)) > 3.1) continue;
    ++tested;
    Jacobian J_A;
    ASSERT_TRUE(analyticalJacobian(kinematics, J_A));
    for (int i = 0; i < n; ++i) {
      const JointVector h = kStep * JointVector::Unit(n, i);
      const Pose before = tipPose(model, q - h), after = tipPose(model, q + h);
      Vector6 column;
      column << after.p - before.p, zyzFromRotation(after.R) - zyzFromRotation(before.R);
      EXPECT_LT((J_A.col(i) - column / (2 * kStep)).norm(), 100 * kDifference);  // 1 / sin(theta)^2 enlarges it
    }
  }
  EXPECT_GT(tested, 100);
}

TEST(AnalyticalJacobian, IsTheGeometricOneThroughTheRateMatrix) {
  const Kinematics kinematics =
      kinematicsAt(test::randomChain(6, 3), JointVector::Constant(6, 0.4), JointVector::Zero(6));
  Jacobian J_A;
  ASSERT_TRUE(analyticalJacobian(kinematics, J_A));
  const Matrix3 T = zyzRateMatrix(zyzFromRotation(kinematics.X_WE.R));
  EXPECT_LT((T * J_A.bottomRows<3>() - kinematics.J.bottomRows<3>()).norm(), 1e-13);
  EXPECT_EQ(J_A.topRows<3>(), kinematics.J.topRows<3>());
}

TEST(AnalyticalJacobian, OfTheRppTurnsOnlyTheta) {
  for (const double q1 : {0.3, 2.0}) {  // theta = pi/2 - q1 or q1 - pi/2; phi and psi stay
    Jacobian J_A;
    ASSERT_TRUE(analyticalJacobian(kinematicsAt(test::rppRobot(), Vector3(q1, 0.1, 0.1), Vector3::Zero()), J_A));
    EXPECT_LT((J_A.block<3, 1>(3, 0) - Vector3(0.0, q1 < kPi / 2 ? -1.0 : 1.0, 0.0)).norm(), 1e-14);
    EXPECT_LT((J_A.bottomRightCorner<3, 2>().norm()), 1e-14);
  }
}

TEST(AnalyticalJacobian, IsRefusedWhereTheAnglesAreSingularAndLeftAlone) {
  Jacobian J_A = Jacobian::Constant(6, 3, 7.0);
  EXPECT_FALSE(analyticalJacobian(kinematicsAt(test::rppRobot(), Vector3(kPi / 2, 0.1, 0.1), Vector3::Zero()), J_A));
  EXPECT_EQ(J_A, Jacobian::Constant(6, 3, 7.0));
  Kinematics broken = kinematicsAt(test::rppRobot(), kReportQ, Vector3::Zero());
  broken.X_WE.R(0, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(analyticalJacobian(broken, J_A));
}

TEST(DampedAnalyticalJacobian, IsTheAnalyticalOneAwayFromTheSingularity) {
  std::mt19937 generator(8);
  for (int k = 0; k < 100; ++k) {
    const RobotModel model = test::randomChain(5, k);
    const Kinematics kinematics = kinematicsAt(model, test::randomJointVector(generator, 5, 3.0), JointVector::Zero(5));
    if (std::sin(zyzFromRotation(kinematics.X_WE.R)(1)) < 0.1) continue;
    Jacobian J_A;
    ASSERT_TRUE(analyticalJacobian(kinematics, J_A));
    EXPECT_EQ(dampedAnalyticalJacobian(kinematics), J_A);
  }
}

/// A tip tilted by theta from the vertical, at angle phi, that can turn about each axis of the world.
Kinematics tilted(double phi, double theta) {
  Kinematics kinematics;
  kinematics.X_WE.R =
      (Eigen::AngleAxisd(phi, Vector3::UnitZ()) * Eigen::AngleAxisd(theta, Vector3::UnitY())).toRotationMatrix();
  kinematics.J.setZero(6, 3);
  kinematics.J.bottomRows<3>() = Matrix3::Identity();
  return kinematics;
}

TEST(DampedAnalyticalJacobian, ExistsEverywhereBoundedAndWithoutASeam) {
  for (const double theta : {0.0, 1e-12, 1e-8, 1e-4, 0.01, 0.03, 0.05, 0.07, 0.09, 0.0999, 0.1001}) {
    for (const double tilt : {theta, kPi - theta}) {
      const Jacobian J_A = dampedAnalyticalJacobian(tilted(0.7, tilt));
      EXPECT_LT(J_A.cwiseAbs().maxCoeff(), 12.0) << tilt;
      // theta's rate, which has no singularity, is untouched, except that phi is 0 by convention where it has no value.
      const double phi = std::sin(theta) < 1e-9 ? 0.0 : 0.7;
      EXPECT_LT((J_A.row(4) - Eigen::RowVector3d(-std::sin(phi), std::cos(phi), 0.0)).norm(), 1e-6) << tilt;
    }
  }
  const double edge = std::asin(0.1);
  const Jacobian inside = dampedAnalyticalJacobian(tilted(0.7, edge - 1e-9));
  const Jacobian outside = dampedAnalyticalJacobian(tilted(0.7, edge + 1e-9));
  EXPECT_LT((inside - outside).norm(), 1e-5);  // 2e-9 times a slope of 1e2 to 1e3
}

TEST(DampedAnalyticalJacobian, LeavesTheRppAsItIsThroughTheVertical) {
  for (const double gap : {-0.05, -1e-3, -1e-6, 0.0, 1e-6, 1e-3, 0.05}) {
    const Jacobian J_A =
        dampedAnalyticalJacobian(kinematicsAt(test::rppRobot(), Vector3(kPi / 2 + gap, 0.1, 0.1), Vector3::Zero()));
    EXPECT_LT((J_A.block<3, 1>(3, 0) - Vector3(0.0, gap <= 0.0 ? -1.0 : 1.0, 0.0)).norm(), 1e-9) << gap;
  }
}

}  // namespace
}  // namespace baton
