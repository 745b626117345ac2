/// Joint PD with gravity compensation: tau = g(q) + Kp e - Kd qd,  e = q_d - q.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 8.5.1.
/// Assumes a set-point: the desired velocity is zero, and damping acts on the joint velocity itself. It then holds with
/// any positive Kp, Kd; at rest without gravity compensation Kp e = g(q).
/// The report prints -Kd qdd. That would feed back acceleration: it adds inertia and damps nothing.
#include "control/law.hpp"
#include "control/model_terms.hpp"

namespace baton::laws {
namespace {

class JointPd final : public Law {
 public:
  JointPd(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        gravity_(model_, values),
        kp_(vector<JointVector>(values, "kp")),
        kd_(vector<JointVector>(values, "kd")) {}

  void reset() noexcept override {}
  void handover(const LawInput&) noexcept override {}

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const RobotState& state = input.state;
    const Reference& ref = input.reference;
    if (ref.q.size() != model_.size()) return LawStatus::kMissingReference;
    if (!state.q.allFinite() || !state.qd.allFinite() || !ref.q.allFinite()) return LawStatus::kNotFinite;

    JointVector effort;
    gravity_.effort(model_, state.q, effort);
    effort += kp_.cwiseProduct(ref.q - state.q) - kd_.cwiseProduct(state.qd);

    if (!effort.allFinite()) return LawStatus::kNotFinite;
    tau = effort;
    return LawStatus::kOk;
  }

 private:
  RobotModel model_;
  GravityCompensation gravity_;
  JointVector kp_, kd_;
};

}  // namespace

LawInfo jointPd() {
  std::vector<ParameterSpec> parameters = {
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
  };
  for (ParameterSpec& spec : gravityParameters()) parameters.push_back(std::move(spec));
  parameters.push_back(massScaleParameter());
  return {.name = "joint_pd",
          .summary = "joint PD with gravity compensation, for set-points",
          .parameters = std::move(parameters),
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<JointPd>(model, values);
          }};
}

}  // namespace baton::laws
