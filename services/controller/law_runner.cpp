#include "law_runner.hpp"

#include "base/error.hpp"

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
      parameters_(service, config_, info_, checkpoint_out_.firstStep()),
      inputs_(info_.uses_force ? 3 : 2),
      effort_(JointVector::Zero(service.scenario().robot.size())),
      command_out_(service, dds::topics::kJointCommand, withRecorder({kPlantName}, service.scenario())),
      shadow_out_(service, dds::topics::kShadowCommand, withRecorder({}, service.scenario())),
      ack_out_(service.output(dds::topics::kSwapAck, withRecorder({kPlantName}, service.scenario()))),
      status_out_(service.output(dds::topics::kControllerStatus)) {
  input_.dt_s = service.scenario().stepSeconds();
  prepare(message_);
  ack_.effort().reserve(kMaxJoints);
  ack_.controller(config_.name);
  owed_.reserve(kMaxOwed);
  law_state_.resize(msg::MAX_CHECKPOINT);
  for (const PlannedFailure& failure : service.scenario().failures) {
    const bool is_restart = failure.controller == config_.name && failure.restarted;
    // One from before a branch is behind the state that the branch starts from.
    if (is_restart && *failure.returns_at_step >= checkpoint_out_.firstStep()) {
      restarts_.push_back(*failure.returns_at_step);
    }
  }
  checkpoint_out_.restore(*this);
  parameters_.publish();
  service.input(dds::topics::kPlantState, {kPlantName},
                [this](const msg::PlantState& message, const dds::RawSample& sample) { onState(message, sample); });
  service.input(dds::topics::kReference, {kTrajectoryName},
                [this](const msg::Reference& message, const dds::RawSample& sample) { onReference(message, sample); });
  if (info_.uses_force) {
    service.input(dds::topics::kContact, {kEnvironmentName},
                  [this](const msg::Contact& message, const dds::RawSample& sample) { onContact(message, sample); });
  }
  service.input(dds::topics::kSwapPlan, {kPlantName}, [this](const msg::SwapPlan& plan, const dds::RawSample& sample) {
    if (!service_.isFromBefore(sample)) onPlan(plan);
  });
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
  const bool has_news = parameters_.advance(step);
  restartAsPlanned(step);
  if (!holds && !last_command && !service_.scenario().hot_standby) {
    active_ = false;
    history_[slot].resize(0);
  } else {
    // From the second step with the baton on, a law's state goes on by itself; before, it is asked anew at every step
    // what it would do if it received the baton there. At the start of a run there is nothing to take over.
    const bool continues = last_command || (holds && (active_ || step == 0));
    const bool forgets = holds && fresh_step_ == step;
    evaluate(step, forgets ? Start::kForgets : continues ? Start::kContinues : Start::kTakesOver);
    active_ = holds;
    publish(step, holds || last_command);
  }
  if (has_news) parameters_.publish();
  answerForecasts();
  service_.stepDone(step);
}

/// This process stands for one that had died and was started again: that one would remember nothing.
void LawRunner::restartAsPlanned(std::uint64_t step) {
  for (; next_restart_ < restarts_.size() && restarts_[next_restart_] <= step; ++next_restart_)
    parameters_.law().reset();
}

bool LawRunner::isQuiet(std::uint64_t step) const {
  // The reference comes a step early; everything else of the step is what it was computed from.
  return inputs_.lastDone() && *inputs_.lastDone() >= step && inputs_.has(kReference, step + 1);
}

void LawRunner::forget() {
  parameters_.rewind();
  inputs_ = StepInputs(info_.uses_force ? 3 : 2);
  active_ = failing_ = false;
  next_restart_ = 0;
  owed_.clear();
  last_command_step_.reset();
  fresh_step_.reset();
  for (JointVector& effort : history_) effort.resize(0);
}

void LawRunner::archive(StateArchive& state) {
  // The state of another law, or of another arm, may have the same length.
  const auto joints = static_cast<std::uint64_t>(effort_.size());
  const std::uint64_t own = dds::chainHash(joints, std::as_bytes(std::span(info_.name)));
  std::uint64_t whose = own;
  state(whose, active_);
  if (whose != own) return state.fail();
  parameters_.archive(state);
  parameters_.law().archive(state);
}

LawStatus LawRunner::callLaw(std::uint64_t step, Start start, LawInput& input, JointVector& effort) {
  const std::size_t slot = StepInputs::slot(step);
  input.state = states_[slot];
  input.reference = references_[slot];
  input.contact = contacts_[slot];
  Law& law = parameters_.law();
  if (start == Start::kTakesOver) law.handover(input);
  if (start == Start::kForgets) law.reset();
  return law.step(input, effort);
}

void LawRunner::evaluate(std::uint64_t step, Start start) {
  const std::size_t slot = StepInputs::slot(step);
  last_status_ = callLaw(step, start, input_, effort_);
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
    case msg::SWAP_FORECAST:
      if (!isIncoming(plan)) return;
      if (owed_.size() == kMaxOwed) owed_.erase(owed_.begin());
      owed_.push_back(plan);
      answerForecasts();  // the step may have gone by before the plan came
      return;
    case msg::SWAP_COMMIT:
      if (is_outgoing) last_command_step_ = plan.at_step();
      if (isIncoming(plan) && plan.hard()) fresh_step_ = plan.at_step();
      acknowledge(plan, true, {}, "");
      return;
    case msg::SWAP_CANCEL:
      std::erase_if(owed_, [&](const msg::SwapPlan& one) {
        return one.phase() == msg::SWAP_PREPARE && one.plan_id() == plan.plan_id();
      });
      if (is_outgoing) last_command_step_.reset();
      if (isIncoming(plan)) fresh_step_.reset();
      return;
  }
}

void LawRunner::answerForecasts() {
  const auto last = inputs_.lastDone();
  std::erase_if(owed_, [&](const msg::SwapPlan& plan) {
    if (!last || *last < plan.forecast_step()) return false;
    answer(plan);
    return true;
  });
}

void LawRunner::answer(const msg::SwapPlan& plan) {
  const std::uint64_t step = plan.forecast_step();
  const std::size_t inputs = info_.uses_force ? 3 : 2;
  for (std::size_t input = 0; input < inputs; ++input) {
    if (!inputs_.has(input, step)) return acknowledge(plan, false, {}, "it has not computed that step");
  }
  // What it does in shadow is what it would command. A hard handover is another matter, and a law that stands by cold
  // has done nothing: these are tried out.
  JointVector effort = history_[StepInputs::slot(step)];
  LawStatus status = LawStatus::kOk;
  if (plan.hard()) {
    status = tryOut(step, Start::kForgets, effort);
  } else if (effort.size() == 0) {
    status = tryOut(step, Start::kTakesOver, effort);
  }
  acknowledge(plan, status == LawStatus::kOk, effort, status == LawStatus::kOk ? "" : toString(status));
}

/// What the law would give at a step, without a trace.
LawStatus LawRunner::tryOut(std::uint64_t step, Start start, JointVector& effort) {
  Law& law = parameters_.law();
  StateArchive saved = StateArchive::into(law_state_);
  law.archive(saved);
  LawInput input = input_;
  effort = effort_;
  const LawStatus status = callLaw(step, start, input, effort);
  StateArchive back = StateArchive::from(std::span(law_state_).first(saved.size()));
  law.archive(back);
  return status;
}

void LawRunner::acknowledge(const msg::SwapPlan& plan, bool ready, const JointVector& effort, const char* reason) {
  ack_.plan_id(plan.plan_id());
  ack_.phase(plan.phase());
  ack_.ready(ready);
  if (ready) {
    assignSequence(effort, ack_.effort());
  } else {
    ack_.effort().clear();
  }
  ack_.reason(reason);
  ack_out_.write(ack_);
}

void LawRunner::publishStatus() {
  msg::ControllerStatus status;
  status.name(config_.name);
  status.law(config_.law);
  status.uses_force(info_.uses_force);
  status.step(inputs_.lastDone().value_or(0));
  const bool is_cold = !active_ && !service_.scenario().hot_standby;  // it has computed nothing at that step
  if (!inputs_.lastDone()) {
    status.state(msg::CONTROLLER_STARTING);
  } else if (active_) {
    status.state(failing_ ? msg::CONTROLLER_FAILED : msg::CONTROLLER_ACTIVE);
  } else if (is_cold) {
    status.state(msg::CONTROLLER_COLD);
  } else {
    status.state(failing_ ? msg::CONTROLLER_FAILED : msg::CONTROLLER_STANDBY);
  }
  if (inputs_.lastDone() && !failing_ && !is_cold) {
    assignSequence(effort_, status.effort());
    assignSequence(effort_ - input_.state.tau_applied, status.effort_gap());
  } else if (failing_) {
    status.text(toString(last_status_));
  }
  if (skipped_ > 0) status.text("skipped " + std::to_string(skipped_) + " steps whose inputs did not come");
  status_out_.write(status);
}

}  // namespace baton
