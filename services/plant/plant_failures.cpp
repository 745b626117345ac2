// Controllers that are lost and come back, by what befalls their processes or because the scenario plans it; and the
// decisions that a re-run takes instead.
#include "plant.hpp"

namespace baton {

void Plant::memberLost(int member, const char* reason) {
  Member& one = members_[static_cast<std::size_t>(member)];
  one.is_lost = true;
  one.is_new = false;
  takeForFailed(member, reason);
  if (reset_) resetAcknowledged(arbiter_.nameOf(member));
}

void Plant::memberFound(int member) {
  members_[static_cast<std::size_t>(member)].is_lost = false;
  letReturn(member);
}

void Plant::takeForFailed(int member, const char* reason) {
  const std::uint64_t step = master_.step();
  const bool was_holder = member == arbiter_.holder();
  const bool was_outgoing = member == arbiter_.outgoingAt(step);
  members_[static_cast<std::size_t>(member)].fails_when_commanded = false;
  decideFailure(member, reason);
  if (was_holder && !master_.hasCommand()) {
    keepTorque();  // the open step is its own still
    master_.commandArrived(step);
  }
  if (was_outgoing) master_.needOutgoing(false);
  dry_runs_.memberFailed(member);
  publishDryRuns();
  publishBaton();
}

void Plant::decideFailure(int member, const char* reason) {
  if (arbiter_.hasFailed(member)) return;
  const std::uint64_t step = master_.step();
  const bool as_holder = member == arbiter_.holder() && master_.hasCommand();
  const bool as_outgoing = member == arbiter_.outgoingAt(step) && master_.hasOutgoingCommand();
  msg::Decision decision = decisionOf(msg::DECISION_FAILED, member);
  decision.at_step(step + 1);
  decision.commanded(as_holder || as_outgoing);
  decision.reason(reason);
  decision_out_.write(decision);
  arbiter_.memberFailed(member, step, reason);
}

/// Neither by itself nor by the scenario does anything speak against it. As holder it never returns by itself.
void Plant::letReturn(int member) {
  const Member& one = members_[static_cast<std::size_t>(member)];
  if (one.is_lost || one.is_lost_as_planned || !arbiter_.hasFailed(member)) return;
  arbiter_.memberReturned(member);
  if (arbiter_.hasFailed(member)) return;              // the open step is its own still
  if (master_.phase() == SimPhase::kStarting) return;  // a branch begins with whom it has
  msg::Decision decision = decisionOf(msg::DECISION_RETURNED, member);
  decision.restarted(one.is_new);
  decision_out_.write(decision);
  service_.event(msg::SEVERITY_INFO, "returned", arbiter_.nameOf(member) + " answers again and stands by");
  publishBaton();
}

/// Who is not there when the run, or a new take of it, begins.
std::vector<int> Plant::absentAtBegin() {
  const std::vector<int> planned = failure_script_.begin(master_.firstStep());
  for (Member& one : members_) one.is_lost_as_planned = one.fails_when_commanded = false;
  for (const int member : planned) members_[static_cast<std::size_t>(member)].is_lost_as_planned = true;
  std::vector<int> absent;
  for (int member = 0; member < static_cast<int>(members_.size()); ++member) {
    const Member& one = members_[static_cast<std::size_t>(member)];
    if (!one.is_lost && !one.is_lost_as_planned) continue;
    absent.push_back(member);
    msg::Decision decision = decisionOf(msg::DECISION_FAILED, member);
    decision.step(master_.firstStep());
    decision.at_step(master_.firstStep());
    decision.reason("it had failed before the first step");
    decision_out_.write(decision);
  }
  return absent;
}

void Plant::failAsPlanned() {
  const std::uint64_t step = master_.step();
  for (int member = 0; member < static_cast<int>(members_.size()); ++member) letReturn(member);
  while (const auto event = failure_script_.next(step)) {
    Member& one = members_[static_cast<std::size_t>(event->member)];
    if (event->returns) {
      one.is_lost_as_planned = false;
      one.is_new = event->restarted;
      letReturn(event->member);
      continue;
    }
    one.is_lost_as_planned = true;
    const bool is_needed = event->member == arbiter_.holder() || event->member == arbiter_.outgoingAt(step);
    if (event->commanded && is_needed) {
      one.fails_when_commanded = true;
    } else {
      takeForFailed(event->member, kPlannedFailure);
    }
  }
}

void Plant::commandedAsPlanned(int member) {
  if (members_[static_cast<std::size_t>(member)].fails_when_commanded) takeForFailed(member, kPlannedFailure);
}

void Plant::stopAsPlanned() {
  while (next_stop_ < scenario_.stops.size() && scenario_.stops[next_stop_].decided_at_step <= master_.step()) {
    (void)stopAt(scenario_.stops[next_stop_++].at_step);
  }
}

bool Plant::stopAt(std::uint64_t step) {
  if (!master_.endAt(step)) return false;
  decideEnd(step);
  arbiter_.endAt(step);
  publishSwapActions();
  return true;
}

void Plant::decideEnd(std::uint64_t step) {
  msg::Decision decision = decisionOf(msg::DECISION_END, kBrake);
  decision.at_step(step);
  decision_out_.write(decision);
}

msg::Decision Plant::decisionOf(msg::DecisionCause cause, int member) const {
  msg::Decision decision;
  decision.step(master_.step());
  decision.take(take_);
  decision.cause(cause);
  decision.controller(arbiter_.nameOf(member));
  decision.at_step(master_.step());
  return decision;
}

}  // namespace baton
