// What the plant says besides the state of each step: plans and outcomes of handovers, how the run stands.
#include "plant.hpp"

namespace baton {

void Plant::publishSwapActions() {
  while (const std::optional<ArbiterAction> action = arbiter_.takeAction()) {
    const HandoverPlan& plan = action->plan;
    using Kind = ArbiterAction::Kind;
    if (action->kind == Kind::kDone) {
      if (completed_) publishDone(*completed_, "it lost the baton before its first command", {}, {});
      completed_ = plan;
      completed_reason_ = action->reason;
      service_.event(plan.plan_id == 0 ? msg::SEVERITY_WARNING : msg::SEVERITY_INFO, "swap",
                     nameOf(plan.incoming).empty() ? "the brake holds; " + std::string(action->reason.data())
                                                   : nameOf(plan.incoming) + " holds the baton");
      continue;
    }
    if (action->kind == Kind::kRefused) {
      publishRefusal(plan, action->reason.data());
      service_.event(msg::SEVERITY_WARNING, "swap_refused",
                     (plan.incoming == kBrake ? "" : nameOf(plan.incoming) + ": ") + action->reason.data());
      continue;
    }
    msg::SwapPlan message;
    message.plan_id(plan.plan_id);
    message.phase(action->kind == Kind::kPrepare  ? msg::SWAP_PREPARE
                  : action->kind == Kind::kCommit ? msg::SWAP_COMMIT
                                                  : msg::SWAP_CANCEL);
    message.outgoing(nameOf(plan.outgoing));
    message.incoming(nameOf(plan.incoming));
    message.forecast_step(plan.forecast_step);
    message.at_step(plan.at_step);
    plan_out_.write(message);
  }
}

namespace {
msg::SwapOutcome outcomeOf(const HandoverPlan& plan, const char* reason) {
  msg::SwapOutcome outcome;
  outcome.request_id(plan.request_id);
  outcome.plan_id(plan.plan_id);
  outcome.decided_at_step(plan.decided_at_step);
  outcome.at_step(plan.at_step);
  outcome.reason(reason);
  return outcome;
}
}  // namespace

void Plant::publishRefusal(const HandoverPlan& plan, const char* reason) {
  msg::SwapOutcome outcome = outcomeOf(plan, reason);
  outcome.outgoing(nameOf(plan.outgoing));
  outcome.incoming(nameOf(plan.incoming));
  outcome.take(take_);
  outcome_out_.write(outcome);
}

void Plant::publishDone(const HandoverPlan& plan, const char* reason, const JointVector& raw_step,
                        const JointVector& applied_step) {
  msg::SwapOutcome outcome = outcomeOf(plan, reason);
  outcome.done(true);
  outcome.outgoing(nameOf(plan.outgoing));
  outcome.incoming(nameOf(plan.incoming));
  outcome.blend_steps(scenario_.baton.blend_steps);
  assignSequence(raw_step, outcome.raw_effort_step());
  assignSequence(applied_step, outcome.applied_effort_step());
  outcome.take(take_);
  outcome_out_.write(outcome);
}

std::string Plant::namesWaitedFor() const {
  std::string names;
  for (const std::string& name : waited_for_) names += (names.empty() ? "" : ", ") + name;
  return names;
}

void Plant::publishStatus() {
  msg::SimStatus status;
  switch (master_.phase()) {
    case SimPhase::kStarting: status.state(msg::SIM_STATE_STARTING); break;
    case SimPhase::kRunning: status.state(msg::SIM_STATE_RUNNING); break;
    case SimPhase::kPaused: status.state(msg::SIM_STATE_PAUSED); break;
    case SimPhase::kFinished: status.state(msg::SIM_STATE_FINISHED); break;
    case SimPhase::kAborted: status.state(msg::SIM_STATE_ABORTED); break;
  }
  status.mode(isRealtime() ? msg::SIM_MODE_REALTIME : msg::SIM_MODE_LOCKSTEP);
  status.step(master_.step());
  status.time_ns(service_.stampOf(master_.step()).time_ns);
  status.step_ns(scenario_.step_ns);
  status.take(take_);
  status.first_step(checkpoints_.firstStep());
  status.end_step(master_.endStep());
  status.rate(pacer_.rate());
  const std::int64_t until = ended_ns_ != 0 ? ended_ns_ : steadyNow();
  status.elapsed_s(started_ns_ == 0 ? 0.0 : static_cast<double>(until - started_ns_) * 1e-9);
  status.holder(nameOf(arbiter_.holder()));
  const Hold hold = master_.hold();
  if (hold == Hold::kNotStarted) {
    status.waiting_for(namesWaitedFor());
  } else if (hold != Hold::kNone && hold != Hold::kEnded) {
    status.waiting_for(toString(hold));
  }
  status.reason(end_reason_);
  status.missed_steps(missed_);
  status.chain_hash(chain_hash_);
  // First: whoever sees the end of the run has its timing already.
  timing_out_.write(timing_.report(master_.step(), missed_));
  status_out_.write(status);
}

}  // namespace baton
