#include "control/tip_pd.hpp"

#include <cmath>
#include <utility>

#include "control/model_terms.hpp"
#include "control/task_space.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

/// Desired minus actual in ZYZ angles, each the short way round.
Vector6 zyzError(const Pose& X_WD, const Pose& X_WE) noexcept {
  constexpr double kTurn = 2.0 * 3.14159265358979323846;
  const Vector3 difference = zyzFromRotation(X_WD.R) - zyzFromRotation(X_WE.R);
  Vector6 error;
  error << X_WD.p - X_WE.p, difference.unaryExpr([](double angle) { return std::remainder(angle, kTurn); });
  return error;
}

class TipPd final : public Law {
 public:
  TipPd(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        gravity_(model_, values),
        kp_(vector<Vector6>(values, "kp")),
        kd_(vector<Vector6>(values, "kd")),
        has_zyz_(choice(values, "orientation") == "zyz") {}

  void reset() noexcept override {}
  void handover(const LawInput&) noexcept override {}

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    const Pose& X_WD = input.reference.X_WE;
    if (!input.reference.has_task) return LawStatus::kMissingReference;
    if (!q.allFinite() || !qd.allFinite() || !X_WD.R.allFinite() || !X_WD.p.allFinite()) return LawStatus::kNotFinite;

    computeKinematics(model_, q, qd, kinematics_);
    const Vector6 x_error = has_zyz_ ? zyzError(X_WD, kinematics_.X_WE) : poseError(X_WD, kinematics_.X_WE);
    const Jacobian J = has_zyz_ ? dampedAnalyticalJacobian(kinematics_) : kinematics_.J;
    const Vector6 xd = J * qd;
    const Vector6 wrench = kp_.cwiseProduct(x_error) - kd_.cwiseProduct(xd);

    JointVector effort;
    gravity_.effort(model_, q, effort);
    effort.noalias() += J.transpose() * wrench;
    if (!effort.allFinite()) return LawStatus::kNotFinite;
    tau = effort;
    return LawStatus::kOk;
  }

 private:
  RobotModel model_;
  GravityCompensation gravity_;
  Vector6 kp_, kd_;
  bool has_zyz_;  // else the rotation vector
  Kinematics kinematics_;
};

}  // namespace

std::unique_ptr<Law> makeTipPd(const RobotModel& model, const ParameterValues& values) {
  return std::make_unique<TipPd>(model, values);
}

std::vector<ParameterSpec> tipPdParameters(std::vector<double> kp, std::vector<double> kd) {
  std::vector<ParameterSpec> parameters = {
      {.name = "kp",
       .unit = "N/m; N m/rad",
       .doc = "stiffness of the tip",
       .size = ParameterSize::kSix,
       .default_numbers = std::move(kp),
       .minimum = 0.0,
       .choices = {}},
      {.name = "kd",
       .unit = "N s/m; N m s/rad",
       .doc = "damping of the tip",
       .size = ParameterSize::kSix,
       .default_numbers = std::move(kd),
       .minimum = 0.0,
       .choices = {}},
      {.name = "orientation",
       .unit = "",
       .doc = "orientation error: ZYZ angles as in the report, or the rotation vector, which has no singularity",
       .size = ParameterSize::kChoice,
       .default_numbers = {},
       .choices = {"zyz", "rotation_vector"}},
  };
  for (ParameterSpec& spec : gravityParameters()) parameters.push_back(std::move(spec));
  parameters.push_back(massScaleParameter());
  return parameters;
}

}  // namespace baton
