#include "control/force_control.hpp"

#include <cmath>

#include "control/anti_windup.hpp"
#include "control/model_terms.hpp"
#include "control/task_space.hpp"
#include "robot/dynamics.hpp"

namespace baton {
namespace {

class ForceControl final : public Law {
 public:
  ForceControl(ForceLoop loop, const RobotModel& model, const ParameterValues& values)
      : loop_(loop),
        model_(believedModel(model, values)),
        md_(vector<Vector3>(values, "md")),
        kd_(vector<Vector3>(values, "kd")),
        kp_(vector<Vector3>(values, "kp")),
        kf_(vector<Vector3>(values, "kf")),
        ki_(vector<Vector3>(values, "ki")) {
    solver_.null_space_damping = number(values, "null_space_damping");
  }

  void reset() noexcept override {
    has_integral_ = false;
    commanded_.resize(0);
  }

  void handover(const LawInput& input) noexcept override {
    reset();
    if (check(input) != LawStatus::kOk || !input.state.tau_applied.allFinite()) return;
    // The law read backwards: from tau_applied to y, to the tip's acceleration, to x_F.
    JointVector y;
    if (!appliedAcceleration(model_, input.state, input.contact.h_e, y)) return;
    computeKinematics(model_, input.state.q, input.state.qd, kinematics_);
    const Vector3 acceleration = kinematics_.J.topRows<3>() * y + kinematics_.Jdot_qd.head<3>();
    const Vector3 velocity = kinematics_.V_WE.head<3>();
    const Vector3 offset = md_.cwiseProduct(acceleration) + kd_.cwiseProduct(velocity);
    const Vector3 x_F = kinematics_.X_WE.p + offset.cwiseQuotient(kp_) - origin(input.reference);
    integral_ = x_F - kf_.cwiseProduct(forceError(input));
    has_integral_ = integral_.allFinite();
  }

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const LawStatus checked = check(input);
    if (checked != LawStatus::kOk) return checked;
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    computeKinematics(model_, q, qd, kinematics_);
    const Vector3 x = kinematics_.X_WE.p;
    const Vector3 x_0 = origin(input.reference);
    const Vector3 f_error = forceError(input);
    Vector3 w = integral_;
    if (!has_integral_) w = loop_ == ForceLoop::kAlone ? Vector3(x - kf_.cwiseProduct(f_error)) : Vector3::Zero();

    const Vector3 x_F = kf_.cwiseProduct(f_error) + w;
    const Vector3 force = kp_.cwiseProduct(x_0 + x_F - x) - kd_.cwiseProduct(kinematics_.V_WE.head<3>());
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
    tau = effort;
    return LawStatus::kOk;
  }

  void archive(StateArchive& state) noexcept override { state(integral_, has_integral_, commanded_); }

 private:
  LawStatus check(const LawInput& input) const noexcept {
    const Reference& ref = input.reference;
    if (loop_ == ForceLoop::kAroundPosition) {
      if (!ref.has_task) return LawStatus::kMissingReference;
      if (!ref.X_WE.p.allFinite()) return LawStatus::kNotFinite;
    }
    const bool is_finite = std::isfinite(input.dt_s) && input.state.q.allFinite() && input.state.qd.allFinite() &&
                           input.contact.h_e.allFinite() && ref.h_d.allFinite();
    return is_finite ? LawStatus::kOk : LawStatus::kNotFinite;
  }

  /// x_0, the point x_F is counted from.
  Vector3 origin(const Reference& reference) const noexcept {
    return loop_ == ForceLoop::kAroundPosition ? reference.X_WE.p : Vector3::Zero();
  }

  static Vector3 forceError(const LawInput& input) noexcept {
    return input.reference.h_d.head<3>() - input.contact.h_e.head<3>();
  }

  /// Whether this increment of w would push further in a joint whose last effort was cut by its limit.
  bool windsUp(const Vector3& increment, const RobotState& state) const noexcept {
    const JointVector cut = cutDirections(model_, commanded_, state.tau_applied);
    if (cut.isZero(0.0)) return false;
    Vector6 a = Vector6::Zero();
    a.head<3>() = kp_.cwiseProduct(increment).cwiseQuotient(md_);
    JointVector y(model_.size());
    if (solveTask(solver_, kinematics_, a, JointVector::Zero(model_.size()), y) != LawStatus::kOk) return true;
    JointMatrix B;
    massMatrix(model_, state.q, B);
    return pushesFurther(cut, B * y);
  }

  ForceLoop loop_;
  RobotModel model_;
  TaskSolver solver_;  // position
  Vector3 md_, kd_, kp_, kf_, ki_;
  Kinematics kinematics_;
  Vector3 integral_ = Vector3::Zero();  // w [m]
  bool has_integral_ = false;           // false until a run's first step or a handover
  JointVector commanded_;               // effort of the step before; no entries when there was none
};

}  // namespace

std::unique_ptr<Law> makeForceControl(ForceLoop loop, const RobotModel& model, const ParameterValues& values) {
  return std::make_unique<ForceControl>(loop, model, values);
}

std::vector<ParameterSpec> forceControlParameters() {
  return {
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
  };
}

}  // namespace baton
