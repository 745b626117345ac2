/// What laws that follow the tip share: the error of a pose, and the joint acceleration that gives a tip acceleration.
///
/// The orientation error is a rotation vector in W and goes with the geometric Jacobian, so no choice of Euler angles
/// can make it jump. The report inverts a 6 x 3 analytical Jacobian, which has no inverse: its arm has three joints.
#pragma once

#include <vector>

#include "base/types.hpp"
#include "control/law.hpp"
#include "control/parameters.hpp"
#include "robot/kinematics.hpp"

namespace baton {

enum class TaskMethod {
  kPosition,            // tip position only: J_P^-1 for three joints, else its pseudo-inverse
  kPseudoInverse,       // position and orientation; least squares when they cannot all be met
  kDampedLeastSquares,  // the same, damped, so that it exists everywhere: J^T (J J^T + damping^2 I)^-1
};

struct TaskSolver {
  TaskMethod method = TaskMethod::kPosition;
  double damping = 0.05;             // of damped least squares; m and rad alike
  double null_space_damping = 10.0;  // joint motion the tip cannot feel is slowed at this rate [1/s]
};

/// Parameters `solver`, `damping` and `null_space_damping`.
[[nodiscard]] std::vector<ParameterSpec> taskSolverParameters();
[[nodiscard]] TaskSolver taskSolver(const ParameterValues& values);
/// Parameter `null_space_damping` alone, for laws that are about position only.
[[nodiscard]] ParameterSpec nullSpaceDampingParameter();

/// Desired minus actual: [p_d - p; rotation vector of R_d R^T], in W [m; rad].
[[nodiscard]] Vector6 poseError(const Pose& X_WD, const Pose& X_WE) noexcept;

/// Whether the task part of a reference is free of NaN and infinity.
[[nodiscard]] bool isTaskFinite(const Reference& reference) noexcept;

/// Joint acceleration y with J y = a, in the sense of the method; Siciliano et al. (2009), sec. 3.5.
/// With more joints than task coordinates, y = J^+ (a + k J qd) - k qd, k the null-space damping: without it the arm
/// would coast for ever in the directions that the tip does not feel.
/// @param a  tip acceleration less Jdot qd [m/s^2; rad/s^2]; the position method reads the first three entries.
/// @param[out] y  n entries; left as it was unless the result is kOk.
/// @return kOk, or kSingular where the matrix to solve is worse conditioned than kMinReciprocalCondition.
[[nodiscard]] LawStatus solveTask(const TaskSolver& solver, const Kinematics& kinematics, const Vector6& a,
                                  const JointVector& qd, JointVector& y) noexcept;

/// Nearer to a singularity than this, a tip acceleration of 1 m/s^2 may ask a joint for 10^4 times as much.
inline constexpr double kMinReciprocalCondition = 1e-4;

}  // namespace baton
