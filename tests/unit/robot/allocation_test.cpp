/// No function of the hot path touches the heap, and the guard that says so can see it.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <new>

#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "robot/regressor.hpp"
#include "robot/simulation.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

TEST(AllocationGuard, SeesWhatTheStandardLibraryAndEigenAllocate) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  const test::AllocationGuard guard;
  EXPECT_EQ(guard.count(), 0u);
  void* const block = ::operator new(16);  // called by name: a new-expression may be optimised away
  EXPECT_EQ(guard.count(), 1u);
  ::operator delete(block);
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(20, 20);
  EXPECT_EQ(guard.count(), 2u) << matrix(0, 0);
}

TEST(RobotHotPath, NeverAllocates) {
  for (const int n : {1, 3, kMaxJoints}) {
    const RobotModel model = test::randomChain(n, 1);
    const JointVector q = JointVector::Constant(n, 0.3), qd = JointVector::Constant(n, 0.2);
    const Vector6 h_e = Vector6::Constant(1.0);
    Contact contact;
    contact.df_dp(2, 2) = 10.0;

    const test::AllocationGuard guard;
    Kinematics kinematics;
    computeKinematics(model, q, qd, kinematics);
    Jacobian J_A;
    EXPECT_TRUE(analyticalJacobian(kinematics, J_A));
    EXPECT_TRUE(dampedAnalyticalJacobian(kinematics).allFinite());
    const Matrix3 R = tipPose(model, q).R;
    const Vector3 angles = zyzFromRotation(R) + zyzRateMatrix(rotationVector(R)).col(0);
    EXPECT_TRUE(angles.allFinite());

    JointVector tau, bias, gravity, friction, qdd;
    JointMatrix B;
    LagrangeTerms lagrange;
    inverseDynamics(model, q, qd, qd, h_e, tau);
    biasEffort(model, q, qd, bias);
    gravityEffort(model, q, gravity);
    frictionEffort(model, qd, friction);
    massMatrix(model, q, B);
    lagrangeDynamics(model, q, qd, lagrange);
    Regressor Y;
    dynamicsRegressor(model, q, qd, qd, qd, Y);
    EXPECT_TRUE((Y * dynamicParameters(model)).allFinite());
    EXPECT_TRUE(forwardDynamics(model, q, qd, tau, h_e, qdd));
    EXPECT_GT(kineticEnergy(model, q, qd) + std::abs(potentialEnergy(model, q)), 0.0);

    JointVector q_next = q, qd_next = qd;
    EXPECT_EQ(saturateEffort(model, tau), 0);
    EXPECT_TRUE(integrateStep(model, tau, contact, 1e-3, 2, q_next, qd_next));
    EXPECT_EQ(guard.count(), 0u) << n << " joints";
  }
}

}  // namespace
}  // namespace baton
