#include "control/arm.hpp"

#include "robot/dynamics.hpp"
#include "robot/simulation.hpp"

namespace baton {

const char* toString(Coupling coupling) {
  switch (coupling) {
    case Coupling::kDerivatives: return "derivatives";
    case Coupling::kHeld: return "held";
    case Coupling::kLate: return "late";
  }
  return "?";
}

Arm::Arm(const RobotModel& model, const ArmConfig& config) : model_(model), config_(config) { reset(); }

void Arm::reset() {
  state_.q = config_.start_q;
  state_.qd = config_.start_qd;
  state_.tau_applied = JointVector::Zero(model_.size());
  blend_ = {};
  h_e_before_.reset();
  updateTip();
}

void Arm::updateTip() {
  computeKinematics(model_, state_.q, state_.qd, kinematics_);
  state_.X_WE = kinematics_.X_WE;
  state_.V_WE = kinematics_.V_WE;
}

JointVector Arm::brakeEffort() const {
  JointVector g;
  JointMatrix B;
  gravityEffort(model_, state_.q, g);
  massMatrix(model_, state_.q, B);
  JointVector tau = g;
  tau.noalias() -= kBrakeRate * (B * state_.qd);
  return tau;
}

JointVector Arm::residual(std::uint64_t step) const {
  JointVector tau = JointVector::Zero(model_.size());
  blend_.add(step, tau);
  return tau;
}

JointVector Arm::blended(std::uint64_t step, const JointVector& effort) const {
  JointVector tau = effort;
  blend_.add(step, tau);
  return tau;
}

JointVector Arm::holdingEffort(std::uint64_t step) const {
  return 2.0 * state_.tau_applied - blended(step, state_.tau_applied);
}

void Arm::archive(StateArchive& state) noexcept {
  bool has_before = h_e_before_.has_value();
  Vector6 before = h_e_before_.value_or(Vector6::Zero());
  state(state_.q, state_.qd, state_.tau_applied, has_before, before);
  blend_.archive(state);
  if (!state.isRestoring() || !state.isGood()) return;
  for (const JointVector* one : {&state_.q, &state_.qd, &state_.tau_applied}) {
    if (one->size() != model_.size() || !one->allFinite()) return state.fail();
  }
  h_e_before_.reset();
  if (has_before) h_e_before_ = before;
  updateTip();
}

Contact Arm::felt(const Contact& contact) const {
  if (config_.coupling == Coupling::kDerivatives) return contact;
  Contact held;
  held.h_e = config_.coupling == Coupling::kLate ? h_e_before_.value_or(contact.h_e) : contact.h_e;
  return held;
}

bool Arm::move(const JointVector& tau, const Contact& contact) {
  JointVector applied = tau;
  saturateEffort(model_, applied);
  if (!integrateStep(model_, applied, felt(contact), config_.step_s, config_.substeps, state_.q, state_.qd))
    return false;
  h_e_before_ = contact.h_e;
  state_.tau_applied = applied;
  updateTip();
  return true;
}

}  // namespace baton
