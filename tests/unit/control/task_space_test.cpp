#include "control/task_space.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

/// Random configurations of a chain and what solveTask makes of a random acceleration there.
struct Problem {
  Kinematics kinematics;
  JointVector qd, y;
  Vector6 a;
};

Problem randomProblem(const RobotModel& robot, std::mt19937& generator) {
  const int n = robot.size();
  Problem problem;
  problem.qd = randomJointVector(generator, n, 1.0);
  computeKinematics(robot, randomJointVector(generator, n, 1.5), problem.qd, problem.kinematics);
  problem.a = randomJointVector(generator, 6, 1.0);
  return problem;
}

/// J^+ by orthogonal decomposition, a route that the code under test does not use.
Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& J) { return J.completeOrthogonalDecomposition().pseudoInverse(); }

TEST(TaskSpace, SolvesAsThePseudoInverseWithDampedNullSpace) {
  constexpr double kNullSpaceDamping = 4.0;
  for (const TaskMethod method : {TaskMethod::kPosition, TaskMethod::kPseudoInverse}) {
    const int rows = method == TaskMethod::kPosition ? 3 : 6;
    for (int n = 1; n <= kMaxJoints; ++n) {
      const RobotModel robot = randomRevoluteChain(n, 30 + n);
      std::mt19937 generator(n);
      int solved = 0;
      for (int i = 0; i < 50; ++i) {
        Problem problem = randomProblem(robot, generator);
        const TaskSolver solver{.method = method, .null_space_damping = kNullSpaceDamping};
        if (solveTask(solver, problem.kinematics, problem.a, problem.qd, problem.y) != LawStatus::kOk) continue;
        ++solved;
        const Eigen::MatrixXd J = problem.kinematics.J.topRows(rows);
        const Eigen::MatrixXd J_plus = pseudoInverse(J);
        const Eigen::VectorXd null_motion = problem.qd - J_plus * J * problem.qd;
        Eigen::VectorXd expected = J_plus * problem.a.head(rows);
        expected -= kNullSpaceDamping * null_motion;
        // The normal equations lose twice the digits of the condition number.
        const double condition = J.norm() * J_plus.norm();
        EXPECT_LT((problem.y - expected).norm(), 1e-15 * condition * condition * (10.0 + expected.norm()))
            << "n = " << n << ", condition " << condition;
        if (n >= rows) {
          EXPECT_LT((J * problem.y - problem.a.head(rows)).norm(), 1e-14 * condition * condition * 10.0);
        }
      }
      EXPECT_GE(solved, 45) << "n = " << n;
    }
  }
}

TEST(TaskSpace, DampedLeastSquaresMinimisesErrorPlusDampedMotion) {
  constexpr double kDamping = 0.05;
  for (int n = 1; n <= 6; ++n) {
    const RobotModel robot = randomChain(n, 40 + n);
    std::mt19937 generator(n);
    for (int i = 0; i < 50; ++i) {
      Problem problem = randomProblem(robot, generator);
      const TaskSolver solver{.method = TaskMethod::kDampedLeastSquares, .damping = kDamping};
      ASSERT_EQ(solveTask(solver, problem.kinematics, problem.a, problem.qd, problem.y), LawStatus::kOk);
      // Gradient of |J y - a|^2 + damping^2 |y|^2.
      const Jacobian& J = problem.kinematics.J;
      const JointVector gradient = J.transpose() * (J * problem.y - problem.a) + kDamping * kDamping * problem.y;
      EXPECT_LT(gradient.norm(), 1e-11) << n;  // a few roundings of |J|^2 |y|, with |y| up to |a| / (2 damping)
    }
  }
}

TEST(TaskSpace, SaysWhereThePositionJacobianHasNoInverse) {
  // The report's arm: det J_P = L = a2 + a4 + q3 vanishes where the tip is on the axis of joint 1.
  const RobotModel robot = rppRobot();
  const JointVector qd = JointVector::Zero(3);
  Kinematics kinematics;
  const JointVector marker = Vector3(7.0, 8.0, 9.0);
  for (const double L : {0.0, 1e-6, -1e-6, 1e-2, -0.3, 0.55}) {
    computeKinematics(robot, Vector3(0.4, 0.1, L - 0.55), qd, kinematics);
    JointVector y = marker;
    const LawStatus expected = std::abs(L) < 1e-4 ? LawStatus::kSingular : LawStatus::kOk;
    EXPECT_EQ(solveTask({}, kinematics, Vector6::Ones(), qd, y), expected) << L;
    if (expected == LawStatus::kSingular) {
      EXPECT_EQ(y, marker);
    } else {
      EXPECT_LT((kinematics.J.topRows<3>() * y - Vector3::Ones()).norm(), 1e-12);
    }
    const TaskSolver damped{.method = TaskMethod::kDampedLeastSquares};
    EXPECT_EQ(solveTask(damped, kinematics, Vector6::Ones(), qd, y), LawStatus::kOk);
  }
}

TEST(TaskSpace, PoseErrorTurnsTheActualIntoTheDesired) {
  const RobotModel robot = randomRevoluteChain(6, 50);
  std::mt19937 generator(51);
  for (int i = 0; i < 50; ++i) {
    const Pose X_WE = tipPose(robot, randomJointVector(generator, 6, 3.0));
    const Pose X_WD = tipPose(robot, randomJointVector(generator, 6, 3.0));
    const Vector6 error = poseError(X_WD, X_WE);
    EXPECT_LT((X_WE.p + error.head<3>() - X_WD.p).norm(), 1e-14);
    const Vector3 turn = error.tail<3>();
    const Matrix3 turned = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * X_WE.R;
    EXPECT_LT((turned - X_WD.R).norm(), 1e-12);
    EXPECT_LE(turn.norm(), kPi + 1e-12);
  }
}

}  // namespace
}  // namespace baton
