#include <gtest/gtest.h>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

constexpr double kStep = 2e-4;                 // s; Kd / m3 = 1700 1/s is the fastest pole
constexpr double kKp = 550.0, kKpTurn = 30.0;  // the report's values and the law's defaults
const JointVector kTarget = Vector3(kPi / 6, 0.2, 0.1);

/// The arm at rest against a wall of stiffness Ke.
struct Rest {
  Vector3 x_error;      // desired minus actual [m]
  double force;         // on the wall, along z [N]
  JointVector spring;   // J^T Kp x~ [N m or N]
  JointVector contact;  // J_P^T f_e
};

Rest restAgainst(double Ke, const std::string& orientation) {
  const RobotModel robot = rppRobot();
  ClosedLoop loop(robot, makeLaw("compliance", robot, {{"orientation", orientation}}), kStep, JointVector::Zero(3),
                  [&](double) { return setPoint(robot, kTarget); });
  loop.Ke_N_per_m = Ke;
  loop.run(10.0);
  EXPECT_LT(loop.input.state.qd.norm(), 1e-8);

  Kinematics kinematics;
  computeKinematics(robot, loop.q(), JointVector::Zero(3), kinematics);
  const Pose X_WD = tipPose(robot, kTarget);
  const Matrix3 R = kinematics.X_WE.R;
  Jacobian J = kinematics.J;
  Vector6 wrench;
  wrench << kKp * (X_WD.p - loop.tip()), kKpTurn * rotationVector(X_WD.R * R.transpose());
  if (orientation == "zyz") {
    EXPECT_TRUE(analyticalJacobian(kinematics, J));
    wrench.tail<3>() = kKpTurn * (zyzFromRotation(X_WD.R) - zyzFromRotation(R));
  }
  return {X_WD.p - loop.tip(), loop.force().z(), J.transpose() * wrench,
          kinematics.J.topRows<3>().transpose() * loop.force()};
}

TEST(Compliance, RestsWhereTheSpringCarriesTheContactForce) {
  for (const char* orientation : {"zyz", "rotation_vector"}) {
    for (const double Ke : {50.0, 5000.0}) {
      const Rest rest = restAgainst(Ke, orientation);
      EXPECT_LT((rest.spring - rest.contact).norm(), 1e-6) << orientation << " " << Ke;
      EXPECT_GT(rest.force, 0.5);
      EXPECT_LT(std::abs(rest.x_error.y()), 1e-9);  // the wall cannot reach y, whatever the report sees
    }
  }
}

TEST(Compliance, AStifferWallTakesMoreForceAndLeavesMoreError) {
  const Rest soft = restAgainst(50.0, "zyz"), stiff = restAgainst(5000.0, "zyz");
  EXPECT_GT(stiff.force, 3 * soft.force);
  EXPECT_GT(stiff.x_error.z(), 3 * soft.x_error.z());
}

TEST(Compliance, ReachesTheSetPointOutOfContact) {
  for (const char* orientation : {"zyz", "rotation_vector"}) {
    const Rest rest = restAgainst(0.0, orientation);
    EXPECT_LT(rest.x_error.norm(), 1e-9) << orientation;
    EXPECT_EQ(rest.force, 0.0);
  }
}

}  // namespace
}  // namespace baton
