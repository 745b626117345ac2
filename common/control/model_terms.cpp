#include "control/model_terms.hpp"

#include <Eigen/Cholesky>

#include "robot/dynamics.hpp"

namespace baton {

ParameterSpec modelUseParameter() {
  return {.name = "model",
          .unit = "",
          .doc = "terms of the model that are used: leaving out inertia sets B = I, leaving out bias sets n = 0",
          .size = ParameterSize::kChoice,
          .default_numbers = {},
          .choices = {"full", "ignore_inertia", "ignore_bias", "ignore_both"}};
}

ModelUse modelUse(const ParameterValues& values) {
  const std::string word = choice(values, "model");
  if (word == "ignore_inertia") return ModelUse::kIgnoreInertia;
  if (word == "ignore_bias") return ModelUse::kIgnoreBias;
  if (word == "ignore_both") return ModelUse::kIgnoreBoth;
  return ModelUse::kFull;
}

ParameterSpec massScaleParameter() {
  return {.name = "mass_scale",
          .unit = "",
          .doc = "the law's model has every link this many times as heavy as the robot file",
          .size = ParameterSize::kScalar,
          .default_numbers = {1.0},
          .minimum = 1e-3,
          .maximum = 1e3,
          .choices = {}};
}

RobotModel believedModel(const RobotModel& model, const ParameterValues& values) {
  const double scale = number(values, "mass_scale");
  RobotModel believed = model;
  for (Joint& joint : believed.joints) {
    joint.link.mass_kg *= scale;
    joint.link.first_moment_kg_m *= scale;
    joint.link.inertia_origin_kg_m2 *= scale;
  }
  return believed;
}

void computedEffort(const RobotModel& model, ModelUse use, const JointVector& q, const JointVector& qd,
                    const JointVector& y, JointVector& tau) noexcept {
  switch (use) {
    case ModelUse::kFull: inverseDynamics(model, q, qd, y, Vector6::Zero(), tau); break;
    case ModelUse::kIgnoreInertia:
      biasEffort(model, q, qd, tau);
      tau += y;
      break;
    case ModelUse::kIgnoreBias: {
      JointMatrix B;
      massMatrix(model, q, B);
      tau.noalias() = B * y;
      break;
    }
    case ModelUse::kIgnoreBoth: tau = y; break;
  }
}

bool appliedAcceleration(const RobotModel& model, const RobotState& state, const Vector6& h_e,
                         JointVector& y) noexcept {
  const JointVector no_acceleration = JointVector::Zero(model.size());
  JointVector held;
  inverseDynamics(model, state.q, state.qd, no_acceleration, h_e, held);
  JointMatrix B;
  massMatrix(model, state.q, B);
  const Eigen::LLT<JointMatrix> llt(B);
  if (llt.info() != Eigen::Success) return false;
  const JointVector result = llt.solve(state.tau_applied - held);
  if (!result.allFinite()) return false;
  y = result;
  return true;
}

GravityCompensation::GravityCompensation(const RobotModel& believed, const ParameterValues& values)
    : follows_position_(choice(values, "gravity") == "full"), fixed_(JointVector::Zero(believed.size())) {
  if (choice(values, "gravity") == "fixed") {
    gravityEffort(believed, vector<JointVector>(values, "gravity_position"), fixed_);
  }
}

void GravityCompensation::effort(const RobotModel& believed, const JointVector& q, JointVector& g) const noexcept {
  if (follows_position_) {
    gravityEffort(believed, q, g);
  } else {
    g = fixed_;
  }
}

std::vector<ParameterSpec> gravityParameters() {
  return {{.name = "gravity",
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
           .choices = {}}};
}

}  // namespace baton
