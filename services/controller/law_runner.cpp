#include "law_runner.hpp"

#include "base/error.hpp"
#include "base/plural.hpp"

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
      law_(service.scenario(), config_, checkpoint_out_.firstStep()),
      info_(law_.info()),
      parameters_(service, config_, law_, checkpoint_out_.firstStep()),
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
  checkpoint_out_.restore(law_);
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
    const msg::ControllerStatus now = status();
    if (status_pace_.isDue(now)) publish(now);
  });
}

void LawRunner::onState(const msg::PlantState& message, const dds::RawSample& sample) {
  if (!service_.isReady() || !inputs_.wants(kState, message.step())) return;
  const std::size_t slot = StepInputs::slot(message.step());
  RobotState decoded;  // what is refused leaves no trace
  if (const Reading reading = fromMessage(message, service_.scenario().robot.size(), decoded); !reading) {
    return service_.refuse(dds::topics::kPlantState, message.step(), reading);
  }
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
  if (const Reading reading = fromMessage(message, service_.scenario().robot.size(), decoded); !reading) {
    return service_.refuse(dds::topics::kReference, message.step(), reading);
  }
  references_[slot] = decoded;
  hashes_[slot][kReference] = dds::chainHash(0, sample.payload);
  arrived(kReference, message.step());
  service_.considerRewind();
}

void LawRunner::onContact(const msg::Contact& message, const dds::RawSample& sample) {
  if (!inputs_.wants(kContact, message.step())) return;
  const std::size_t slot = StepInputs::slot(message.step());
  Contact decoded;  // what is refused leaves no trace
  if (const Reading reading = fromMessage(message, decoded); !reading) {
    return service_.refuse(dds::topics::kContact, message.step(), reading);
  }
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
  if (checkpoints_[slot]) checkpoint_out_.save(step, law_);
  parameters_.at(step);
  const bool has_news = law_.advance(step);
  if (!holds && !last_command && !service_.scenario().hot_standby) {
    law_.skip();
    history_[slot].resize(0);
  } else {
    const RunningLaw::Role role{.holds = holds, .commands_once_more = last_command, .forgets = fresh_step_ == step};
    fill(input_, step);
    last_status_ = law_.compute(step, role, input_, effort_);
    if (last_status_ == LawStatus::kOk) {
      history_[slot] = effort_;
    } else {
      history_[slot].resize(0);
    }
    publish(step, holds || last_command);
  }
  if (has_news) parameters_.publish();
  answerForecasts();
  service_.stepDone(step);
}

bool LawRunner::isQuiet(std::uint64_t step) const {
  // The reference comes a step early; everything else of the step is what it was computed from.
  return inputs_.lastDone() && *inputs_.lastDone() >= step && inputs_.has(kReference, step + 1);
}

void LawRunner::forget() {
  law_.rewind();
  parameters_.rewind();
  inputs_ = StepInputs(info_.uses_force ? 3 : 2);
  failing_ = false;
  owed_.clear();
  last_command_step_.reset();
  fresh_step_.reset();
  for (JointVector& effort : history_) effort.resize(0);
}

void LawRunner::fill(LawInput& input, std::uint64_t step) const {
  const std::size_t slot = StepInputs::slot(step);
  input.state = states_[slot];
  input.reference = references_[slot];
  input.contact = contacts_[slot];
}

void LawRunner::publish(std::uint64_t step, bool commands) {
  const std::size_t slot = StepInputs::slot(step);
  const bool has_effort = last_status_ == LawStatus::kOk;
  const bool is_news = !has_effort && !failing_;
  failing_ = !has_effort;
  if (has_effort || commands) {
    // Without an effort, the plant must hear so at this very step, or it would wait: an empty command says it.
    const std::size_t inputs = info_.uses_force ? 3 : 2;
    const std::uint64_t inputs_hash = dds::inputsHash(std::span(hashes_[slot]).first(inputs));
    toMessage(service_.stampOf(step), config_.name, history_[slot], inputs_hash, message_);
    // Before its command: the plant has the cause when it takes the baton away.
    if (!has_effort) publish(status());
    (commands ? command_out_ : shadow_out_).write(message_);
  }
  if (is_news) {
    service_.event(commands ? msg::SEVERITY_ERROR : msg::SEVERITY_INFO, "law",
                   config_.name + " has no effort to give: " + toString(last_status_));
  }
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
  if (plan.hard() || effort.size() == 0) {
    LawInput input = input_;
    fill(input, step);
    effort = effort_;
    status = law_.tryOut(plan.hard(), input, effort);
  }
  acknowledge(plan, status == LawStatus::kOk, effort, status == LawStatus::kOk ? "" : toString(status));
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

msg::ControllerStatus LawRunner::status() const {
  msg::ControllerStatus status;
  status.name(config_.name);
  status.law(config_.law);
  status.uses_force(info_.uses_force);
  status.step(inputs_.lastDone().value_or(0));
  const bool is_cold = !law_.isActive() && !service_.scenario().hot_standby;  // it has computed nothing at that step
  if (!inputs_.lastDone()) {
    status.state(msg::CONTROLLER_STARTING);
  } else if (law_.isActive()) {
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
  if (skipped_ > 0 && !failing_) status.text("skipped " + counted(skipped_, "step") + " whose inputs did not come");
  return status;
}

void LawRunner::publish(const msg::ControllerStatus& status) {
  status_out_.write(status);
  status_pace_.wrote(status);
}

}  // namespace baton
