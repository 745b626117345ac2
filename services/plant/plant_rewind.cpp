// Back to the first step without a new process. Nobody may still have something of the run so far on its way when the
// first step opens again, so there are two phases: all services say that the open step is behind them, whole; then all
// forget the run and say so.
#include <algorithm>

#include "plant.hpp"

namespace baton {

void Plant::askForReset(std::uint64_t request_id) {
  reset_ = Reset{.request_id = request_id, .asked_ns = steadyNow(), .phase = {}, .waited_for = {}};
  master_.holdForRewind(true);
  arbiter_.prepareRewind();
  publishSwapActions();
  prepareReset();
}

void Plant::prepareReset() {
  // The open step must have all its inputs: what has been answered is no longer on its way.
  if (!reset_ || reset_->phase || master_.inputsHold() != Hold::kNone) return;
  publishRewind(msg::REWIND_PREPARE);
}

void Plant::publishRewind(msg::RewindPhase phase) {
  reset_->phase = phase;
  for (const std::string& name : servicesBut(kPlantName, scenario_)) {
    const int member = memberCalled(name);
    const bool is_gone = member == kBrake ? name == kRecorderName && has_recorder_failed_
                                          : members_[static_cast<std::size_t>(member)].is_lost;
    if (!is_gone) reset_->waited_for.insert(name);
  }
  msg::Rewind message;
  message.take(next_take_);
  message.phase(phase);
  message.at_step(master_.step());
  rewind_out_.write(message);
  progress_ns_ = steadyNow();
}

void Plant::onRewindAck(const msg::RewindAck& ack) {
  if (!reset_ || ack.take() != next_take_ || ack.phase() != reset_->phase) return;
  resetAcknowledged(ack.name().c_str());
}

void Plant::resetAcknowledged(const std::string& name) {
  reset_->waited_for.erase(name);
  if (!reset_->phase || !reset_->waited_for.empty()) return;
  if (reset_->phase == msg::REWIND_PREPARE) return publishRewind(msg::REWIND_COMMIT);
  finishReset();
}

/// Somebody does not answer.
void Plant::giveUpReset() {
  std::string names;
  for (const std::string& name : reset_->waited_for) names += (names.empty() ? "" : ", ") + name;
  if (reset_->phase == msg::REWIND_COMMIT) return abort("reset: no answer from " + names);
  dropReset(names.empty() ? "the open step does not end" : "no answer from " + names);
  pacer_.anchor(master_.step(), steadyNow());
  armTimer();
  proceed();
}

void Plant::finishReset() {
  const std::uint64_t from_step = master_.step();
  const std::uint64_t request_id = reset_->request_id;
  reset_.reset();
  refuseScheduled("the run was reset");
  dry_runs_.dropAll("the run was reset");
  publishDryRuns();
  publishReport(true);
  arm_.reset();
  arbiter_.prepareRewind();  // what has been asked for meanwhile
  publishSwapActions();
  take_ = next_take_++;
  scheduleSwaps();
  master_.rewind();
  next_stop_ = 0;
  arbiter_.rewind(absentAtBegin());
  if (completed_) publishRefusal(*completed_, "the run was reset");
  completed_.reset();
  contact_ = Contact{};
  effort_.setZero();
  chain_hash_ = 0;
  missed_ = missed_in_a_row_ = silent_in_a_row_ = 0;
  warned_step_ = kNever;
  timing_ = {};
  started_ns_ = steadyNow();
  pacer_.anchor(master_.step(), started_ns_);
  arbiter_.open(master_.step());
  service_.event(msg::SEVERITY_INFO, "reset", "from step " + std::to_string(from_step));
  publishSwapActions();
  openStep();
  publish(status());
  publishBaton();
  msg::SimReply reply;
  reply.request_id(request_id);
  reply.accepted(true);
  reply.step(master_.step());
  reply_out_.write(reply);
  armTimer();
  if (!isRealtime()) proceed();
}

void Plant::dropReset(const std::string& reason) {
  msg::SimReply reply;
  reply.request_id(reset_->request_id);
  reply.step(master_.step());
  reply.reason(reason.substr(0, 199));
  reply_out_.write(reply);
  if (reset_->phase) {
    publishRewind(msg::REWIND_CANCEL);
    ++next_take_;  // what is still on its way belongs to the attempt before
  }
  timing_.interrupted();
  reset_.reset();
  master_.holdForRewind(false);
}

}  // namespace baton
