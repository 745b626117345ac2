/// Force control with an inner position loop and a PI force loop around it:
///   tau = B(q) y + n(q, qd) + J^T h_e,   y = J_P^-1 Md^-1 (-Kd x' + Kp (x_F - x) - Md Jdot_P qd),
///   x_F = Kf (f_d - f_e) + w,   w' = Ki (f_d - f_e),   f_e the force the tip exerts on the environment.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 9.4.1.
/// Assumes contact with an elastic environment: at rest f_e = f_d and x_e = x_F. In a direction where nothing pushes
/// back the tip drifts at Ki (f_d - f_e). Orientation is not controlled.
/// The report prints J^T f_e with a force for a six-row J (the wrench is meant) and does not say where the integral
/// starts; here a new run starts with x_F(0) = x_e(0), so that it does not begin with a leap.
#include <Eigen/Cholesky>
#include <cmath>

#include "control/law.hpp"
#include "control/model_terms.hpp"
#include "control/task_space.hpp"
#include "robot/dynamics.hpp"

namespace baton::laws {
namespace {

class ForcePi final : public Law {
 public:
  ForcePi(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        md_(vector<Vector3>(values, "md")),
        kd_(vector<Vector3>(values, "kd")),
        kp_(vector<Vector3>(values, "kp")),
        kf_(vector<Vector3>(values, "kf")),
        ki_(vector<Vector3>(values, "ki")) {
    solver_.null_space_damping = number(values, "null_space_damping");
  }

  void reset() noexcept override {
    has_integral_ = false;
    has_commanded_ = false;
  }

  void handover(const LawInput& input) noexcept override {
    reset();
    if (!isUsable(input)) return;
    // The law read backwards: from tau_applied to y, to the tip's acceleration, to x_F.
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    computeKinematics(model_, q, qd, kinematics_);
    JointVector held(model_.size());
    inverseDynamics(model_, q, qd, JointVector::Zero(model_.size()), input.contact.h_e, held);
    massMatrix(model_, q, B_);
    const Eigen::LLT<JointMatrix> llt(B_);
    if (llt.info() != Eigen::Success) return;
    const JointVector y = llt.solve(input.state.tau_applied - held);
    const Vector3 acceleration = kinematics_.J.topRows<3>() * y + kinematics_.Jdot_qd.head<3>();
    const Vector3 velocity = kinematics_.V_WE.head<3>();
    const Vector3 offset = md_.cwiseProduct(acceleration) + kd_.cwiseProduct(velocity);
    integral_ = kinematics_.X_WE.p + offset.cwiseQuotient(kp_) - kf_.cwiseProduct(forceError(input));
    has_integral_ = integral_.allFinite();
  }

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    if (!isUsable(input)) return LawStatus::kNotFinite;
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    computeKinematics(model_, q, qd, kinematics_);
    const Vector3 x = kinematics_.X_WE.p;
    const Vector3 f_error = forceError(input);
    const Vector3 w = has_integral_ ? integral_ : Vector3(x - kf_.cwiseProduct(f_error));

    const Vector3 x_F = kf_.cwiseProduct(f_error) + w;
    const Vector3 force = kp_.cwiseProduct(x_F - x) - kd_.cwiseProduct(kinematics_.V_WE.head<3>());
    Vector6 a = -kinematics_.Jdot_qd;
    a.head<3>() += force.cwiseQuotient(md_);
    JointVector y(model_.size());
    const LawStatus solved = solveTask(solver_, kinematics_, a, qd, y);
    if (solved != LawStatus::kOk) return solved;
    JointVector effort(model_.size());
    inverseDynamics(model_, q, qd, y, input.contact.h_e, effort);
    if (!effort.allFinite()) return LawStatus::kNotFinite;

    const Vector3 increment = input.dt_s * ki_.cwiseProduct(f_error);
    integral_ = w;
    if (!windsUp(increment, input.state)) integral_ += increment;
    has_integral_ = true;
    commanded_ = effort;
    has_commanded_ = true;
    tau = effort;
    return LawStatus::kOk;
  }

 private:
  bool isUsable(const LawInput& input) const noexcept {
    return std::isfinite(input.dt_s) && input.state.q.allFinite() && input.state.qd.allFinite() &&
           input.state.tau_applied.allFinite() && input.contact.h_e.allFinite() && input.reference.h_d.allFinite();
  }

  static Vector3 forceError(const LawInput& input) noexcept {
    return input.reference.h_d.head<3>() - input.contact.h_e.head<3>();
  }

  /// Whether this increment would push further in a joint whose last effort was cut by its limit. While a swap's fade
  /// runs, its remainder looks like a cut too, and the integral at most waits for it.
  bool windsUp(const Vector3& increment, const RobotState& state) noexcept {
    if (!has_commanded_) return false;
    constexpr double kNegligibleEffort = 1e-6;  // N m or N; the rounding of a handover is far below
    const JointVector cut = commanded_ - state.tau_applied;
    if (cut.cwiseAbs().maxCoeff() <= kNegligibleEffort) return false;
    Vector6 a = Vector6::Zero();
    a.head<3>() = kp_.cwiseProduct(increment).cwiseQuotient(md_);
    JointVector y(model_.size());
    if (solveTask(solver_, kinematics_, a, JointVector::Zero(model_.size()), y) != LawStatus::kOk) return true;
    massMatrix(model_, state.q, B_);
    const JointVector change = B_ * y;
    return (cut.array().abs() > kNegligibleEffort && cut.array() * change.array() > 0.0).any();
  }

  RobotModel model_;
  TaskSolver solver_;  // position
  Vector3 md_, kd_, kp_, kf_, ki_;
  Kinematics kinematics_;
  JointMatrix B_;
  Vector3 integral_ = Vector3::Zero();  // w [m]
  bool has_integral_ = false;           // false until a run's first step or a handover
  JointVector commanded_;               // effort of the step before
  bool has_commanded_ = false;
};

}  // namespace

LawInfo forcePi() {
  return {.name = "force_pi",
          .summary = "force control: PI on the contact force around a position loop",
          .uses_force = true,
          .requires_contact = true,
          .parameters =
              {
                  {.name = "md",
                   .unit = "kg",
                   .doc = "apparent mass of the tip",
                   .size = ParameterSize::kThree,
                   .default_numbers = {1.0},
                   .minimum = 1e-3,
                   .choices = {}},
                  {.name = "kd",
                   .unit = "N s/m",
                   .doc = "damping of the position loop",
                   .size = ParameterSize::kThree,
                   .default_numbers = {30.0},
                   .minimum = 0.0,
                   .choices = {}},
                  {.name = "kp",
                   .unit = "N/m",
                   .doc = "stiffness of the position loop",
                   .size = ParameterSize::kThree,
                   .default_numbers = {100.0},
                   .minimum = 1e-3,
                   .choices = {}},
                  {.name = "kf",
                   .unit = "m/N",
                   .doc = "proportional gain of the force loop",
                   .size = ParameterSize::kThree,
                   .default_numbers = {0.05},
                   .minimum = 0.0,
                   .choices = {}},
                  {.name = "ki",
                   .unit = "m/(N s)",
                   .doc = "integral gain of the force loop",
                   .size = ParameterSize::kThree,
                   .default_numbers = {0.2},
                   .minimum = 0.0,
                   .choices = {}},
                  massScaleParameter(),
                  nullSpaceDampingParameter(),
              },
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<ForcePi>(model, values);
          }};
}

}  // namespace baton::laws
