/// Joint PD with gravity compensation: tau = g(q) + Kp e - Kd qd,  e = q_d - q.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 8.5.1.
/// Assumes a set-point: the desired velocity is zero, and damping acts on the joint velocity itself. It then holds with
/// any positive Kp, Kd; at rest without gravity compensation Kp e = g(q).
/// The report prints -Kd qdd. That would feed back acceleration: it adds inertia and damps nothing.
#include "control/law.hpp"
#include "control/model_terms.hpp"
#include "robot/dynamics.hpp"

namespace baton::laws {
namespace {

enum class Gravity { kFull, kNone, kFixed };

class JointPd final : public Law {
 public:
  JointPd(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        kp_(vector<JointVector>(values, "kp")),
        kd_(vector<JointVector>(values, "kd")),
        fixed_gravity_(JointVector::Zero(model.size())) {
    const std::string& word = choice(values, "gravity");
    gravity_ = word == "full" ? Gravity::kFull : word == "none" ? Gravity::kNone : Gravity::kFixed;
    if (gravity_ == Gravity::kFixed) {
      gravityEffort(model_, vector<JointVector>(values, "gravity_position"), fixed_gravity_);
    }
  }

  void reset() noexcept override {}
  void handover(const LawInput&) noexcept override {}

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const RobotState& state = input.state;
    const Reference& ref = input.reference;
    if (ref.q.size() != model_.size()) return LawStatus::kMissingReference;
    if (!state.q.allFinite() || !state.qd.allFinite() || !ref.q.allFinite()) return LawStatus::kNotFinite;

    JointVector effort = fixed_gravity_;
    if (gravity_ == Gravity::kFull) gravityEffort(model_, state.q, effort);
    effort += kp_.cwiseProduct(ref.q - state.q) - kd_.cwiseProduct(state.qd);

    if (!effort.allFinite()) return LawStatus::kNotFinite;
    tau = effort;
    return LawStatus::kOk;
  }

 private:
  RobotModel model_;
  JointVector kp_, kd_;
  JointVector fixed_gravity_;  // zero unless gravity is fixed
  Gravity gravity_ = Gravity::kFull;
};

}  // namespace

LawInfo jointPd() {
  return {.name = "joint_pd",
          .summary = "joint PD with gravity compensation, for set-points",
          .parameters =
              {
                  {.name = "kp",
                   .unit = "N m/rad or N/m",
                   .doc = "stiffness",
                   .size = ParameterSize::kPerJoint,
                   .default_numbers = {90.0},
                   .minimum = 0.0,
                   .choices = {}},
                  {.name = "kd",
                   .unit = "N m s/rad or N s/m",
                   .doc = "damping",
                   .size = ParameterSize::kPerJoint,
                   .default_numbers = {60.0},
                   .minimum = 0.0,
                   .choices = {}},
                  {.name = "gravity",
                   .unit = "",
                   .doc = "gravity compensation: at the measured position, none, or fixed at gravity_position",
                   .size = ParameterSize::kChoice,
                   .default_numbers = {},
                   .choices = {"full", "none", "fixed"}},
                  {.name = "gravity_position",
                   .unit = "rad or m",
                   .doc = "joint position whose gravity effort `fixed` compensates",
                   .size = ParameterSize::kPerJoint,
                   .default_numbers = {0.0},
                   .choices = {}},
                  massScaleParameter(),
              },
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<JointPd>(model, values);
          }};
}

}  // namespace baton::laws
