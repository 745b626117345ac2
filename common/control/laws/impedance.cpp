/// Impedance control with force feedback:
///   tau = B(q) y + n(q, qd) + J^T h_e,
///   y = J^-1 Md^-1 (Md xdd_d + Kd x~' + Kp x~ - Md Jdot qd - h_e),   x~ = x_d - x,
/// so that the tip behaves as Md x~'' + Kd x~' + Kp x~ = h_e. h_e is the wrench the tip exerts on the environment.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 9.3.
/// Assumes a model without friction and a configuration away from singularities. At rest Kp x~ = h_e: against a wall
/// normal to z only z is off.
/// The report prints -J^T h_e and leaves h_e out of y. The wrench is then counted twice instead of being cancelled, and
/// at rest Kp x~ = 2 Md J B^-1 J^T h_e, which the arm's own inertia couples into x as well: the x error of the report's
/// Figure 39. Form `as_printed` reproduces that; `no_force` uses no force at all, Kp x~ = Md J B^-1 J^T h_e.
#include "control/law.hpp"
#include "control/model_terms.hpp"
#include "control/task_space.hpp"
#include "robot/dynamics.hpp"

namespace baton::laws {
namespace {

class Impedance final : public Law {
 public:
  Impedance(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        solver_(taskSolver(values)),
        md_(vector<Vector6>(values, "md")),
        kd_(vector<Vector6>(values, "kd")),
        kp_(vector<Vector6>(values, "kp")) {
    const std::string form = choice(values, "form");
    wrench_in_effort_ = form == "corrected" ? 1.0 : form == "as_printed" ? -1.0 : 0.0;
    wrench_in_y_ = form == "corrected" ? 1.0 : 0.0;
  }

  void reset() noexcept override {}
  void handover(const LawInput&) noexcept override {}

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    const Vector6& h_e = input.contact.h_e;
    const Reference& ref = input.reference;
    if (!ref.has_task) return LawStatus::kMissingReference;
    if (!q.allFinite() || !qd.allFinite() || !h_e.allFinite() || !isTaskFinite(ref)) return LawStatus::kNotFinite;

    computeKinematics(model_, q, qd, kinematics_);
    const Vector6 x_error = poseError(ref.X_WE, kinematics_.X_WE);
    const Vector6 xd_error = ref.V_WE - kinematics_.V_WE;
    const Vector6 wrench = kd_.cwiseProduct(xd_error) + kp_.cwiseProduct(x_error) - wrench_in_y_ * h_e;
    const Vector6 a = ref.A_WE + wrench.cwiseQuotient(md_) - kinematics_.Jdot_qd;

    JointVector y(model_.size());
    const LawStatus solved = solveTask(solver_, kinematics_, a, qd, y);
    if (solved != LawStatus::kOk) return solved;
    JointVector effort(model_.size());
    inverseDynamics(model_, q, qd, y, wrench_in_effort_ * h_e, effort);
    if (!effort.allFinite()) return LawStatus::kNotFinite;
    tau = effort;
    return LawStatus::kOk;
  }

 private:
  RobotModel model_;
  TaskSolver solver_;
  Vector6 md_, kd_, kp_;
  double wrench_in_effort_ = 0.0;  // factor of J^T h_e in tau
  double wrench_in_y_ = 0.0;       // factor of -h_e in y
  Kinematics kinematics_;
};

}  // namespace

LawInfo impedance() {
  std::vector<ParameterSpec> parameters = {
      {.name = "md",
       .unit = "kg; kg m^2",
       .doc = "apparent inertia of the tip; the position solver reads the first three",
       .size = ParameterSize::kSix,
       .default_numbers = {1.0},
       .minimum = 1e-3,
       .choices = {}},
      {.name = "kd",
       .unit = "N s/m; N m s/rad",
       .doc = "apparent damping of the tip; the position solver reads the first three",
       .size = ParameterSize::kSix,
       .default_numbers = {30.0},
       .minimum = 0.0,
       .choices = {}},
      {.name = "kp",
       .unit = "N/m; N m/rad",
       .doc = "apparent stiffness of the tip; the position solver reads the first three",
       .size = ParameterSize::kSix,
       .default_numbers = {200.0},
       .minimum = 0.0,
       .choices = {}},
      {.name = "form",
       .unit = "",
       .doc = "the corrected law, the report's printed form, or no force feedback",
       .size = ParameterSize::kChoice,
       .default_numbers = {},
       .choices = {"corrected", "as_printed", "no_force"}},
      massScaleParameter(),
  };
  for (ParameterSpec& spec : taskSolverParameters()) parameters.push_back(std::move(spec));
  return {.name = "impedance",
          .summary = "impedance control: the tip answers contact as a mass, spring and damper",
          .uses_force = true,
          .parameters = std::move(parameters),
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<Impedance>(model, values);
          }};
}

}  // namespace baton::laws
