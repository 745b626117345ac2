// How the run stands, as the plant says it, and the timers that make it look.
#include "plant.hpp"

namespace baton {

std::string Plant::namesWaitedFor() const {
  std::string names;
  for (const std::string& name : waited_for_) names += (names.empty() ? "" : ", ") + name;
  if (names.empty()) names = service_.missing();
  return names.empty() ? "the plant itself" : names;  // it is about to begin
}

msg::SimStatus Plant::status() const {
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
  status.holder(arbiter_.nameOf(arbiter_.holder()));
  const Hold hold = master_.hold();
  if (hold == Hold::kNotStarted) {
    status.waiting_for(namesWaitedFor());
  } else if (hold != Hold::kNone && hold != Hold::kEnded) {
    status.waiting_for(toString(hold));
  }
  status.reason(end_reason_);
  status.missed_steps(missed_);
  status.chain_hash(chain_hash_);
  return status;
}

void Plant::publish(const msg::SimStatus& status) {
  // First: whoever sees the end of the run has its timing already.
  timing_out_.write(timing_.report(master_.step(), missed_));
  status_out_.write(status);
  status_pace_.wrote(status);
}

void Plant::repeatStatus() {
  if (master_.isOver()) return;
  const msg::SimStatus now = status();
  msg::SimStatus at_rest = now;
  at_rest.elapsed_s(status_pace_.last().elapsed_s());  // it alone grows while nothing happens
  if (status_pace_.isDue(at_rest)) publish(now);
}

}  // namespace baton
