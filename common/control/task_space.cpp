#include "control/task_space.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace baton {
namespace {

using TaskVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;
using TaskJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;
using GramMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

LawStatus solveSquarePosition(const Kinematics& kinematics, const Vector3& a, JointVector& y) noexcept {
  const Eigen::PartialPivLU<Matrix3> lu(kinematics.J.topLeftCorner<3, 3>());
  if (!(lu.rcond() >= kMinReciprocalCondition)) return LawStatus::kSingular;  // written so that NaN is singular too
  y = lu.solve(a);
  return LawStatus::kOk;
}

}  // namespace

ParameterSpec nullSpaceDampingParameter() {
  return {.name = "null_space_damping",
          .unit = "1/s",
          .doc = "slows joint motion that the tip does not feel; only matters with more joints than task coordinates",
          .size = ParameterSize::kScalar,
          .default_numbers = {TaskSolver{}.null_space_damping},
          .minimum = 0.0,
          .choices = {}};
}

std::vector<ParameterSpec> taskSolverParameters() {
  return {{.name = "solver",
           .unit = "",
           .doc = "tip position alone, or position and orientation by pseudo-inverse or damped least squares",
           .size = ParameterSize::kChoice,
           .default_numbers = {},
           .choices = {"position", "pseudo_inverse", "damped_least_squares"}},
          {.name = "damping",
           .unit = "",
           .doc = "damping factor of damped_least_squares",
           .size = ParameterSize::kScalar,
           .default_numbers = {TaskSolver{}.damping},
           .minimum = 1e-4,  // below, J J^T + damping^2 I is singular to working precision
           .choices = {}},
          nullSpaceDampingParameter()};
}

TaskSolver taskSolver(const ParameterValues& values) {
  TaskSolver solver;
  const std::string word = choice(values, "solver");
  if (word == "pseudo_inverse") solver.method = TaskMethod::kPseudoInverse;
  if (word == "damped_least_squares") solver.method = TaskMethod::kDampedLeastSquares;
  solver.damping = number(values, "damping");
  solver.null_space_damping = number(values, "null_space_damping");
  return solver;
}

Vector6 poseError(const Pose& X_WD, const Pose& X_WE) noexcept {
  Vector6 error;
  error.head<3>() = X_WD.p - X_WE.p;
  const Matrix3 R_ED_W = X_WD.R * X_WE.R.transpose();
  error.tail<3>() = rotationVector(R_ED_W);
  return error;
}

bool isTaskFinite(const Reference& reference) noexcept {
  return reference.X_WE.R.allFinite() && reference.X_WE.p.allFinite() && reference.V_WE.allFinite() &&
         reference.A_WE.allFinite();
}

LawStatus solveTask(const TaskSolver& solver, const Kinematics& kinematics, const Vector6& a, const JointVector& qd,
                    JointVector& y) noexcept {
  const Eigen::Index n = kinematics.J.cols();
  const Eigen::Index rows = solver.method == TaskMethod::kPosition ? 3 : 6;
  if (rows == 3 && n == 3) return solveSquarePosition(kinematics, a.head<3>(), y);

  const TaskJacobian J = kinematics.J.topRows(rows);
  const double k = n > rows ? solver.null_space_damping : 0.0;
  TaskVector b = a.head(rows);
  b.noalias() += k * (J * qd);

  // The normal equations, on the smaller side: (J^T J)^-1 J^T or J^T (J J^T)^-1. Squaring the condition is harmless
  // here, since anything worse than kMinReciprocalCondition is refused, or damped.
  const bool is_tall = n < rows;
  GramMatrix G(std::min(rows, n), std::min(rows, n));
  if (is_tall) {
    G.noalias() = J.transpose() * J;
  } else {
    G.noalias() = J * J.transpose();
  }
  const bool is_damped = solver.method == TaskMethod::kDampedLeastSquares;
  if (is_damped) G.diagonal().array() += solver.damping * solver.damping;
  const Eigen::LLT<GramMatrix> llt(G);
  if (llt.info() != Eigen::Success) return LawStatus::kSingular;
  if (!is_damped && !(llt.rcond() >= kMinReciprocalCondition * kMinReciprocalCondition)) return LawStatus::kSingular;

  if (is_tall) {
    const TaskVector Jtb = J.transpose() * b;
    y = llt.solve(Jtb);
  } else {
    const TaskVector x = llt.solve(b);
    y.noalias() = J.transpose() * x;
  }
  y -= k * qd;
  return LawStatus::kOk;
}

}  // namespace baton
