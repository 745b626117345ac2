/// Operational-space inverse dynamics:
///   tau = B(q) y + n(q, qd),   y = J^-1 (xdd_d + Kd x~' + Kp x~ - Jdot qd),   x~ = x_d - x.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 8.6.2.
/// Assumes a model without friction and a configuration away from singularities; with the position solver and three
/// joints the tip error then obeys x~'' + Kd x~' + Kp x~ = 0 exactly.
/// The report inverts the analytical Jacobian J_A, which for its arm is 6 x 3 and has no inverse. Here J is the 3 x 3
/// position Jacobian by default, or the whole geometric Jacobian by pseudo-inverse or damped least squares, with the
/// orientation error as a rotation vector (see control/task_space.hpp).
#include "control/law.hpp"
#include "control/model_terms.hpp"
#include "control/task_space.hpp"

namespace baton::laws {
namespace {

class OperationalInverseDynamics final : public Law {
 public:
  OperationalInverseDynamics(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        use_(modelUse(values)),
        solver_(taskSolver(values)),
        kp_(vector<Vector6>(values, "kp")),
        kd_(vector<Vector6>(values, "kd")) {}

  void reset() noexcept override {}
  void handover(const LawInput&) noexcept override {}

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    const Reference& ref = input.reference;
    if (!ref.has_task) return LawStatus::kMissingReference;
    if (!q.allFinite() || !qd.allFinite() || !isTaskFinite(ref)) return LawStatus::kNotFinite;

    computeKinematics(model_, q, qd, kinematics_);
    const Vector6 x_error = poseError(ref.X_WE, kinematics_.X_WE);
    const Vector6 xd_error = ref.V_WE - kinematics_.V_WE;
    const Vector6 a = ref.A_WE + kd_.cwiseProduct(xd_error) + kp_.cwiseProduct(x_error) - kinematics_.Jdot_qd;

    JointVector y(model_.size());
    const LawStatus solved = solveTask(solver_, kinematics_, a, qd, y);
    if (solved != LawStatus::kOk) return solved;
    JointVector effort(model_.size());
    computedEffort(model_, use_, q, qd, y, effort);
    if (!effort.allFinite()) return LawStatus::kNotFinite;
    tau = effort;
    return LawStatus::kOk;
  }

 private:
  RobotModel model_;
  ModelUse use_;
  TaskSolver solver_;
  Vector6 kp_, kd_;
  Kinematics kinematics_;
};

}  // namespace

LawInfo operationalInverseDynamics() {
  std::vector<ParameterSpec> parameters = {
      {.name = "kp",
       .unit = "1/s^2",
       .doc = "stiffness of the error dynamics; the position solver reads the first three",
       .size = ParameterSize::kSix,
       .default_numbers = {280.0, 280.0, 70.0, 70.0, 70.0, 70.0},
       .minimum = 0.0,
       .choices = {}},
      {.name = "kd",
       .unit = "1/s",
       .doc = "damping of the error dynamics; the position solver reads the first three",
       .size = ParameterSize::kSix,
       .default_numbers = {30.0, 30.0, 20.0, 20.0, 20.0, 20.0},
       .minimum = 0.0,
       .choices = {}},
      modelUseParameter(),
      massScaleParameter(),
  };
  for (ParameterSpec& spec : taskSolverParameters()) parameters.push_back(std::move(spec));
  return {.name = "operational_inverse_dynamics",
          .summary = "operational-space inverse dynamics, for tip trajectories",
          .parameters = std::move(parameters),
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<OperationalInverseDynamics>(model, values);
          }};
}

}  // namespace baton::laws
