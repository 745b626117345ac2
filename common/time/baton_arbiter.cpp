#include "time/baton_arbiter.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace baton {
namespace {
using Kind = ArbiterAction::Kind;
using Step = unsigned long long;  // what %llu prints

// Made before main(): a local one is registered for its end at its first use, within a step, which may allocate.
const std::string kNobody;
}  // namespace

BatonArbiter::BatonArbiter(const ArbiterConfig& config)
    : config_(config),
      first_holder_(config.holder),
      holder_(config.holder),
      failed_(config.members.size(), 0),
      failed_at_(config.members.size(), 0) {}

const std::string& BatonArbiter::nameOf(int member) const noexcept {
  return member == kBrake ? kNobody : config_.members[static_cast<std::size_t>(member)].name;
}

void BatonArbiter::act(Kind kind, const HandoverPlan& plan, const char* format, ...) noexcept {
  if (queue_size_ == kQueue) return;  // taken after every request and every step, which make three at most
  ArbiterAction& action = queue_[(queue_head_ + queue_size_++) % kQueue];
  action.kind = kind;
  action.plan = plan;
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(action.reason.data(), action.reason.size(), format, arguments);
  va_end(arguments);
}

std::optional<ArbiterAction> BatonArbiter::takeAction() noexcept {
  if (queue_size_ == 0) return std::nullopt;
  const std::size_t head = queue_head_;
  queue_head_ = (queue_head_ + 1) % kQueue;
  --queue_size_;
  return queue_[head];
}

bool BatonArbiter::hasFailed(int member) const noexcept {
  return member != kBrake && failed_[static_cast<std::size_t>(member)] != 0;
}

std::uint64_t BatonArbiter::failedAt(int member) const noexcept {
  return hasFailed(member) ? failed_at_[static_cast<std::size_t>(member)] : 0;
}

void BatonArbiter::refuseUnknown(std::uint64_t request_id, const char* target, std::uint64_t open_step) noexcept {
  HandoverPlan plan;
  plan.request_id = request_id;
  plan.outgoing = holder_;
  plan.decided_at_step = open_step;
  act(Kind::kRefused, plan, "no controller is called %.40s; see the controllers command", target);
}

HandoverPlan BatonArbiter::planFor(const HandoverRequest& request, std::uint64_t open_step) const noexcept {
  HandoverPlan plan;
  plan.request_id = request.request_id;
  plan.outgoing = holder_;
  plan.incoming = request.target;
  plan.decided_at_step = open_step;
  plan.at_step = request.at_step == 0 ? open_step + 1 + config_.margin_steps : request.at_step;
  plan.force = request.force;
  plan.hard = request.hard;
  plan.blend_steps = request.hard ? 0 : request.blend_steps.value_or(config_.blend_steps);
  return plan;
}

ReasonText BatonArbiter::objectionTo(const HandoverPlan& plan, std::uint64_t open_step) const noexcept {
  ReasonText why{};
  const std::uint64_t earliest = open_step + 1 + config_.margin_steps;
  const auto target = static_cast<std::size_t>(plan.incoming);
  if (plan.incoming < 0 || target >= config_.members.size()) {
    write(why, "no such controller");
    return why;
  }
  const char* name = config_.members[target].name.c_str();
  if (phase_ != Phase::kIdle) {
    write(why, "a handover to %s at step %llu is under way; ask again after it",
          config_.members[static_cast<std::size_t>(plan_.incoming)].name.c_str(), Step{plan_.at_step});
  } else if (holder_failed_at_) {
    write(why, "the holder has failed and step %llu goes to a fallback; ask again after it", Step{open_step + 1});
  } else if (plan.incoming == holder_) {
    write(why, "%s holds the baton already", name);
  } else if (failed_[target] != 0) {
    write(why, "%s has failed", name);
  } else if (plan.at_step < earliest) {
    write(why, "step %llu is too near: step %llu is open and the margin is %llu, so %llu is the first possible",
          Step{plan.at_step}, Step{open_step}, Step{config_.margin_steps}, Step{earliest});
  } else if (config_.end_step > 0 && plan.at_step >= config_.end_step) {
    write(why, "step %llu is not before the end of the run at step %llu", Step{plan.at_step}, Step{config_.end_step});
  }
  return why;
}

void BatonArbiter::request(const HandoverRequest& request, std::uint64_t open_step) noexcept {
  HandoverPlan plan = planFor(request, open_step);
  if (const ReasonText why = objectionTo(plan, open_step); why.front() != '\0') {
    return act(Kind::kRefused, plan, "%s", why.data());
  }
  plan.plan_id = ++last_plan_id_;
  plan.forecast_step = plan.at_step - config_.margin_steps;
  plan_ = plan;
  phase_ = Phase::kPreparing;
  forecast_.reset();
  incoming_committed_ = outgoing_committed_ = false;
  act(Kind::kPrepare, plan_, "%s", "");
}

void BatonArbiter::prepareAcknowledged(std::uint64_t plan_id, int member, const Forecast& forecast) noexcept {
  if (phase_ == Phase::kPreparing && plan_id == plan_.plan_id && member == plan_.incoming) forecast_ = forecast;
}

void BatonArbiter::commitAcknowledged(std::uint64_t plan_id, int member) noexcept {
  if (phase_ != Phase::kCommitted || plan_id != plan_.plan_id) return;
  if (member == plan_.incoming) incoming_committed_ = true;
  if (member == plan_.outgoing) outgoing_committed_ = true;
}

void BatonArbiter::drop(Kind outcome, const char* reason) noexcept {
  act(Kind::kCancel, plan_, "%s", reason);
  act(outcome, plan_, "%s", reason);
  phase_ = Phase::kIdle;
}

void BatonArbiter::consider(std::uint64_t open_step, const JointVector& holder_effort, bool in_contact) noexcept {
  contact_ = in_contact;
  if (phase_ != Phase::kPreparing || open_step < plan_.forecast_step) return;
  const ArbiterMember& incoming = config_.members[static_cast<std::size_t>(plan_.incoming)];
  const bool is_late = open_step != plan_.forecast_step;  // realtime only: there is nothing left to compare with
  if (!forecast_ && !is_late) return;                     // it still may come; in lockstep it will
  if (is_late) {
    ReasonText why{};
    write(why, forecast_ ? "%s forecast step %llu too late" : "%s gave no forecast for step %llu in time",
          incoming.name.c_str(), Step{plan_.forecast_step});
    return drop(Kind::kRefused, why.data());
  }
  const Verdict verdict =
      judge(incoming, *forecast_, {holder_effort, in_contact}, config_.max_effort_step, plan_.force);
  plan_.forecast_effort_step = verdict.effort_step;
  if (!verdict.isFeasible()) return drop(Kind::kRefused, verdict.objection.data());
  phase_ = Phase::kCommitted;
  act(Kind::kCommit, plan_, "%s", "");
}

int BatonArbiter::awaitedMember(std::uint64_t open_step) const noexcept {
  if (phase_ == Phase::kPreparing && open_step >= plan_.forecast_step && !forecast_) return plan_.incoming;
  if (phase_ == Phase::kCommitted && open_step + 1 >= plan_.at_step) {
    if (!incoming_committed_) return plan_.incoming;
    if (!outgoing_committed_ && !hasFailed(plan_.outgoing)) return plan_.outgoing;
  }
  return kBrake;
}

bool BatonArbiter::awaits(std::uint64_t open_step) const noexcept { return awaitedMember(open_step) != kBrake; }

int BatonArbiter::open(std::uint64_t step) noexcept {
  if (holder_failed_at_) {
    HandoverPlan plan;
    plan.outgoing = holder_;
    plan.decided_at_step = *holder_failed_at_;
    plan.at_step = step;
    plan.blend_steps = config_.blend_steps;
    holder_ = kBrake;
    for (const int candidate : config_.fallback) {
      const ArbiterMember& member = config_.members[static_cast<std::size_t>(candidate)];
      if (!hasFailed(candidate) && (contact_ || !member.requires_contact)) {
        holder_ = candidate;
        break;
      }
    }
    plan.incoming = holder_;
    holder_failed_at_.reset();
    changed_at_ = step;
    act(Kind::kDone, plan, "failover: %s", failure_.data());
  } else if (phase_ == Phase::kCommitted && step >= plan_.at_step) {
    if (incoming_committed_) {
      holder_ = plan_.incoming;
      handed_over_by_ = plan_.outgoing;
      changed_at_ = handover_at_ = step;
      act(Kind::kDone, plan_, "%s", "");
      phase_ = Phase::kIdle;
    } else {
      drop(Kind::kRefused, "the incoming controller did not acknowledge the commit in time");
    }
  }
  return holder_;
}

int BatonArbiter::outgoingAt(std::uint64_t step) const noexcept {
  const bool first = handover_at_ && *handover_at_ == step;
  return first && !hasFailed(handed_over_by_) ? handed_over_by_ : kBrake;
}

void BatonArbiter::memberFailed(int member, std::uint64_t open_step, const char* reason) noexcept {
  const auto index = static_cast<std::size_t>(member);
  if (member < 0 || index >= failed_.size() || failed_[index] != 0) return;
  failed_[index] = 1;
  failed_at_[index] = open_step;
  if (phase_ != Phase::kIdle && member == plan_.incoming) drop(Kind::kRefused, reason);
  if (member == holder_) {
    if (phase_ != Phase::kIdle) drop(Kind::kRefused, reason);
    holder_failed_at_ = open_step;
    write(failure_, "%.150s at step %llu", reason, Step{open_step});
  }
}

int BatonArbiter::memberJoined(const ArbiterMember& member) {
  config_.members.push_back(member);
  failed_.push_back(0);
  failed_at_.push_back(0);
  return static_cast<int>(config_.members.size()) - 1;
}

void BatonArbiter::memberChanged(int member, bool requires_contact) noexcept {
  config_.members[static_cast<std::size_t>(member)].requires_contact = requires_contact;
}

void BatonArbiter::memberReturned(int member) noexcept {
  const auto index = static_cast<std::size_t>(member);
  if (member >= 0 && index < failed_.size() && member != holder_) failed_[index] = 0;
}

bool BatonArbiter::isQuiet(std::uint64_t step) const noexcept {
  return phase_ == Phase::kIdle && !holder_failed_at_ && !changedAt(step);
}

void BatonArbiter::archive(StateArchive& state) noexcept {
  state(last_plan_id_, contact_);
  archiveMember(state, holder_);
  auto count = static_cast<std::uint32_t>(failed_.size());
  state(count);
  if (state.isRestoring()) {
    std::fill(failed_.begin(), failed_.end(), char{0});
    std::fill(failed_at_.begin(), failed_at_.end(), 0);
  }
  for (std::uint32_t i = 0; i < count && state.isGood(); ++i) {
    auto member = static_cast<int>(i);
    archiveMember(state, member);
    if (member == kBrake) return state.fail();
    state(failed_[static_cast<std::size_t>(member)], failed_at_[static_cast<std::size_t>(member)]);
  }
}

void BatonArbiter::archiveMember(StateArchive& state, int& member) const noexcept {
  std::array<char, 32> name{};  // that of kBrake is empty
  if (!state.isRestoring() && member != kBrake) {
    const std::string& own = config_.members[static_cast<std::size_t>(member)].name;
    std::copy_n(own.begin(), std::min(own.size(), name.size() - 1), name.begin());
  }
  for (char& letter : name) state(letter);
  if (!state.isRestoring()) return;
  name.back() = '\0';
  const auto& members = config_.members;
  const auto found =
      std::find_if(members.begin(), members.end(), [&](const ArbiterMember& one) { return one.name == name.data(); });
  member = found == members.end() ? kBrake : static_cast<int>(found - members.begin());
  if (member == kBrake && name.front() != '\0') state.fail();
}

void BatonArbiter::prepareRewind() noexcept {
  if (phase_ != Phase::kIdle) drop(Kind::kRefused, "the run is reset");
}

void BatonArbiter::rewind(const std::vector<int>& absent) noexcept {
  phase_ = Phase::kIdle;
  holder_ = first_holder_;
  contact_ = false;
  changed_at_.reset();
  handover_at_.reset();
  handed_over_by_ = kBrake;
  holder_failed_at_.reset();
  std::fill(failed_.begin(), failed_.end(), char{0});
  std::fill(failed_at_.begin(), failed_at_.end(), 0);  // steps are counted anew
  for (const int member : absent) memberFailed(member, 0, "it had failed before the first step");
}

void BatonArbiter::endAt(std::uint64_t step) noexcept {
  config_.end_step = step;
  if (phase_ != Phase::kIdle && plan_.at_step >= step) drop(Kind::kRefused, "the run ends before the handover");
}

void BatonArbiter::runEnded() noexcept {
  if (phase_ != Phase::kIdle) drop(Kind::kRefused, "the run has ended");
}

}  // namespace baton
