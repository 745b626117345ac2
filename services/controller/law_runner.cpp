#include "law_runner.hpp"

#include "base/error.hpp"
#include "parameter_report.hpp"

namespace baton {
namespace {

/// The scenario's entry for this process; checks that --law, when given, says the same.
const ControllerConfig& configOf(const Service& service) {
  const ControllerConfig& config = service.scenario().controller(service.options().name);
  const std::string& law = service.options().law;
  if (!law.empty() && law != config.law) {
    throw UsageError("controller " + config.name + ": expected --law " + config.law + " as in the scenario, found " +
                     law);
  }
  return config;
}

}  // namespace

LawRunner::LawRunner(Service& service)
    : service_(service),
      checkpoint_out_(service),
      config_(configOf(service)),
      info_(findLaw(config_.law)),
      law_(info_.make(service.scenario().robot, config_.parameters)),
      inputs_(info_.uses_force ? 3 : 2),
      effort_(JointVector::Zero(service.scenario().robot.size())),
      command_out_(service.output(dds::topics::kJointCommand, withRecorder({kPlantName}, service.scenario()))),
      shadow_out_(service.output(dds::topics::kShadowCommand, withRecorder({}, service.scenario()))),
      ack_out_(service.output(dds::topics::kSwapAck, withRecorder({kPlantName}, service.scenario()))),
      status_out_(service.output(dds::topics::kControllerStatus)) {
  service.output(dds::topics::kParameterStatus).write(parameterReport(config_));
  input_.dt_s = service.scenario().stepSeconds();
  prepare(message_);
  ack_.effort().reserve(kMaxJoints);
  law_->reset();
  checkpoint_out_.restore(*this);
  service.input(dds::topics::kPlantState, {kPlantName},
                [this](const msg::PlantState& message, const dds::RawSample& sample) { onState(message, sample); });
  service.input(dds::topics::kReference, {kTrajectoryName},
                [this](const msg::Reference& message, const dds::RawSample& sample) { onReference(message, sample); });
  if (info_.uses_force) {
    service.input(dds::topics::kContact, {kEnvironmentName},
                  [this](const msg::Contact& message, const dds::RawSample& sample) { onContact(message, sample); });
  }
  service.input(dds::topics::kSwapPlan, {kPlantName},
                [this](const msg::SwapPlan& plan, const dds::RawSample&) { onPlan(plan); });
  service.onRewind([this](std::uint64_t step) { return isQuiet(step); }, [this] { forget(); });
  service.every(std::chrono::milliseconds(100), [this] {
    const std::lock_guard lock(service_.mutex());
    publishStatus();
  });
}

void LawRunner::onState(const msg::PlantState& message, const dds::RawSample& sample) {
  if (!service_.isReady() || !inputs_.wants(kState, message.step())) return;
  const std::size_t slot = StepInputs::slot(message.step());
  RobotState decoded;  // what is refused leaves no trace
  if (!fromMessage(message, service_.scenario().robot.size(), decoded)) return;
  states_[slot] = decoded;
  holds_[slot] = config_.name == message.holder().c_str();
  checkpoints_[slot] = message.checkpoint();
  hashes_[slot][kState] = dds::chainHash(0, sample.payload);
  arrived(kState, message.step());
}

void LawRunner::onReference(const msg::Reference& message, const dds::RawSample& sample) {
  if (!inputs_.wants(kReference, message.step())) return;
  const std::size_t slot = StepInputs::slot(message.step());
  Reference decoded;  // what is refused leaves no trace
  if (!fromMessage(message, service_.scenario().robot.size(), decoded)) return;
  references_[slot] = decoded;
  hashes_[slot][kReference] = dds::chainHash(0, sample.payload);
  arrived(kReference, message.step());
  service_.considerRewind();
}

void LawRunner::onContact(const msg::Contact& message, const dds::RawSample& sample) {
  if (!inputs_.wants(kContact, message.step())) return;
  const std::size_t slot = StepInputs::slot(message.step());
  Contact decoded;  // what is refused leaves no trace
  if (!fromMessage(message, decoded)) return;
  contacts_[slot] = decoded;
  hashes_[slot][kContact] = dds::chainHash(0, sample.payload);
  arrived(kContact, message.step());
}

void LawRunner::arrived(Input input, std::uint64_t step) {
  if (inputs_.offer(input, step) && !service_.isOver()) compute(step);
}

void LawRunner::compute(std::uint64_t step) {
  const std::size_t slot = StepInputs::slot(step);
  const bool holds = holds_[slot];
  const bool last_command = last_command_step_ == step;  // the step belongs to the next holder, who blends from us
  if (const auto last = inputs_.lastDone(); last && step > *last + 1) skipped_ += step - *last - 1;
  inputs_.done(step);
  service_.at(step);
  if (checkpoints_[slot]) checkpoint_out_.save(step, *this);
  if (!holds && !last_command && !service_.scenario().hot_standby) {
    active_ = false;
    history_[slot].resize(0);
  } else {
    // From the second step with the baton on, a law's state goes on by itself; before, it is asked anew at every step
    // what it would do if it received the baton there. At the start of a run there is nothing to take over.
    const bool continues = last_command || (holds && (active_ || step == 0));
    evaluate(step, continues);
    active_ = holds;
    publish(step, holds || last_command);
  }
  if (forecast_plan_ && step >= forecast_step_) answerForecast();
  service_.stepDone(step);
}

bool LawRunner::isQuiet(std::uint64_t step) const {
  // The reference comes a step early; everything else of the step is what it was computed from.
  return inputs_.lastDone() && *inputs_.lastDone() >= step && inputs_.has(kReference, step + 1);
}

void LawRunner::forget() {
  law_->reset();
  inputs_ = StepInputs(info_.uses_force ? 3 : 2);
  active_ = failing_ = false;
  forecast_plan_.reset();
  last_command_step_.reset();
  for (JointVector& effort : history_) effort.resize(0);
}

void LawRunner::archive(StateArchive& state) {
  // The state of another law, or of another arm, may have the same length.
  const auto joints = static_cast<std::uint64_t>(effort_.size());
  const std::uint64_t own = dds::chainHash(joints, std::as_bytes(std::span(info_.name)));
  std::uint64_t whose = own;
  state(whose, active_);
  if (whose != own) return state.fail();
  law_->archive(state);
}

void LawRunner::evaluate(std::uint64_t step, bool continues) {
  const std::size_t slot = StepInputs::slot(step);
  input_.state = states_[slot];
  input_.reference = references_[slot];
  input_.contact = contacts_[slot];
  if (!continues) law_->handover(input_);
  last_status_ = law_->step(input_, effort_);
  if (last_status_ == LawStatus::kOk) {
    history_[slot] = effort_;
  } else {
    history_[slot].resize(0);
  }
}

void LawRunner::publish(std::uint64_t step, bool commands) {
  const std::size_t slot = StepInputs::slot(step);
  const bool has_effort = last_status_ == LawStatus::kOk;
  if (has_effort || commands) {
    // Without an effort, the plant must hear so at this very step, or it would wait: an empty command says it.
    const std::size_t inputs = info_.uses_force ? 3 : 2;
    const std::uint64_t inputs_hash = dds::inputsHash(std::span(hashes_[slot]).first(inputs));
    toMessage(service_.stampOf(step), config_.name, history_[slot], inputs_hash, message_);
    (commands ? command_out_ : shadow_out_).write(message_);
  }
  if (!has_effort && !failing_) {
    service_.event(commands ? msg::SEVERITY_ERROR : msg::SEVERITY_INFO, "law",
                   config_.name + " has no effort to give: " + toString(last_status_));
  }
  failing_ = !has_effort;
}

bool LawRunner::isIncoming(const msg::SwapPlan& plan) const { return config_.name == plan.incoming().c_str(); }

void LawRunner::onPlan(const msg::SwapPlan& plan) {
  const bool is_outgoing = config_.name == plan.outgoing().c_str();
  if (service_.isOver() || (!isIncoming(plan) && !is_outgoing)) return;
  switch (plan.phase()) {
    case msg::SWAP_PREPARE:
      if (!isIncoming(plan)) return;
      forecast_plan_ = plan.plan_id();
      forecast_step_ = plan.forecast_step();
      // The step may have gone by before the plan came.
      if (const auto last = inputs_.lastDone(); last && *last >= forecast_step_) answerForecast();
      return;
    case msg::SWAP_COMMIT:
      if (is_outgoing) last_command_step_ = plan.at_step();
      ack_.plan_id(plan.plan_id());
      ack_.phase(msg::SWAP_COMMIT);
      ack_.controller(config_.name);
      ack_.ready(true);
      ack_.effort().clear();
      ack_.reason("");
      ack_out_.write(ack_);
      return;
    case msg::SWAP_CANCEL:
      forecast_plan_.reset();
      if (is_outgoing) last_command_step_.reset();
      return;
  }
}

void LawRunner::answerForecast() {
  const std::size_t slot = StepInputs::slot(forecast_step_);
  const std::uint64_t last = inputs_.lastDone().value_or(0);
  const bool in_window = last < forecast_step_ + StepInputs::kWindow;
  // A law that stands by cold is woken by the plan: it computes the forecast's step now.
  if (in_window && history_[slot].size() == 0 && !active_) evaluate(forecast_step_, false);
  const bool has_effort = in_window && history_[slot].size() == effort_.size();
  ack_.plan_id(*forecast_plan_);
  ack_.phase(msg::SWAP_PREPARE);
  ack_.controller(config_.name);
  ack_.ready(has_effort);
  if (has_effort) {
    assignSequence(history_[slot], ack_.effort());
    ack_.reason("");
  } else {
    ack_.effort().clear();
    ack_.reason(last_status_ != LawStatus::kOk ? toString(last_status_) : "it has not computed that step");
  }
  ack_out_.write(ack_);
  forecast_plan_.reset();
}

void LawRunner::publishStatus() {
  msg::ControllerStatus status;
  status.name(config_.name);
  status.law(config_.law);
  status.uses_force(info_.uses_force);
  status.step(inputs_.lastDone().value_or(0));
  if (!inputs_.lastDone()) {
    status.state(msg::CONTROLLER_STARTING);
  } else if (active_) {
    status.state(failing_ ? msg::CONTROLLER_FAILED : msg::CONTROLLER_ACTIVE);
  } else if (!service_.scenario().hot_standby) {
    status.state(msg::CONTROLLER_COLD);
  } else {
    status.state(failing_ ? msg::CONTROLLER_FAILED : msg::CONTROLLER_STANDBY);
  }
  if (inputs_.lastDone() && !failing_) {
    assignSequence(effort_, status.effort());
    assignSequence(effort_ - input_.state.tau_applied, status.effort_gap());
  } else if (failing_) {
    status.text(toString(last_status_));
  }
  if (skipped_ > 0) status.text("skipped " + std::to_string(skipped_) + " steps whose inputs did not come");
  status_out_.write(status);
}

}  // namespace baton
