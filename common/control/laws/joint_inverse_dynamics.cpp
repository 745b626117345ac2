/// Joint-space inverse dynamics: tau = B(q) y + n(q, qd),  y = qdd_d + Kd (qd_d - qd) + Kp (q_d - q),  n = C qd + g.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 8.5.2.
/// Assumes full actuation and a model without friction; the error then obeys e'' + Kd e' + Kp e = 0 exactly.
/// The report writes n and C as functions of qdd, and the feed-forward of y without its index d; both are slips, as C
/// multiplies velocities and a law cannot know the acceleration it is about to cause.
#include "control/law.hpp"
#include "control/model_terms.hpp"

namespace baton::laws {
namespace {

class JointInverseDynamics final : public Law {
 public:
  JointInverseDynamics(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        use_(modelUse(values)),
        kp_(vector<JointVector>(values, "kp")),
        kd_(vector<JointVector>(values, "kd")) {}

  void reset() noexcept override {}
  void handover(const LawInput&) noexcept override {}

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    const Reference& ref = input.reference;
    const int n = model_.size();
    if (ref.q.size() != n || ref.qd.size() != n || ref.qdd.size() != n) return LawStatus::kMissingReference;

    // Every input enters y, and NaN stays NaN even through a zero gain, so this checks them all.
    const JointVector y = ref.qdd + kd_.cwiseProduct(ref.qd - qd) + kp_.cwiseProduct(ref.q - q);
    if (!y.allFinite()) return LawStatus::kNotFinite;
    JointVector effort(n);
    computedEffort(model_, use_, q, qd, y, effort);
    if (!effort.allFinite()) return LawStatus::kNotFinite;
    tau = effort;
    return LawStatus::kOk;
  }

 private:
  RobotModel model_;
  ModelUse use_;
  JointVector kp_, kd_;
};

}  // namespace

LawInfo jointInverseDynamics() {
  return {.name = "joint_inverse_dynamics",
          .summary = "joint-space inverse dynamics (computed torque), for trajectories",
          .parameters =
              {
                  {.name = "kp",
                   .unit = "1/s^2",
                   .doc = "stiffness of the error dynamics",
                   .size = ParameterSize::kPerJoint,
                   .default_numbers = {200.0},
                   .minimum = 0.0,
                   .choices = {}},
                  {.name = "kd",
                   .unit = "1/s",
                   .doc = "damping of the error dynamics",
                   .size = ParameterSize::kPerJoint,
                   .default_numbers = {70.0},
                   .minimum = 0.0,
                   .choices = {}},
                  modelUseParameter(),
                  massScaleParameter(),
              },
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<JointInverseDynamics>(model, values);
          }};
}

}  // namespace baton::laws
