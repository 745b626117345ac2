// Handovers at the plant: requests, plans, acknowledgements and outcomes between the arbiter's rules and DDS; dry runs;
// what a handover did to the arm.
#include <algorithm>
#include <cmath>

#include "plant.hpp"

namespace baton {
namespace {

/// By an operator, not by the scenario.
bool isAsked(const HandoverRequest& request) { return request.request_id != 0; }

void archiveRequest(StateArchive& state, const BatonArbiter& arbiter, HandoverRequest& request) {
  bool has_blend = request.blend_steps.has_value();
  std::uint64_t blend_steps = request.blend_steps.value_or(0);
  arbiter.archiveMember(state, request.target);
  state(request.request_id, request.at_step, request.force, request.hard, has_blend, blend_steps);
  request.blend_steps = has_blend ? std::optional(blend_steps) : std::nullopt;
}

}  // namespace

// --- asked for

void Plant::scheduleSwaps() {
  scheduled_.clear();
  for (const PlannedSwap& swap : scenario_.swaps) {
    scheduled_.push_back({.request_id = 0,
                          .target = memberCalled(swap.to),
                          .at_step = swap.at_step,
                          .force = swap.force,
                          .hard = swap.hard,
                          .blend_steps = swap.blend_steps});
  }
}

/// Of the handovers that wait for their time, those of operators: the scenario's are in the scenario.
void Plant::archiveScheduled(StateArchive& state) {
  auto count = static_cast<std::uint32_t>(std::count_if(scheduled_.begin(), scheduled_.end(), isAsked));
  state(count);
  if (state.isRestoring()) {
    for (; count > 0 && state.isGood(); --count) {
      HandoverRequest request;
      archiveRequest(state, arbiter_, request);
      scheduled_.push_back(request);
    }
  } else {
    for (HandoverRequest& request : scheduled_) {
      if (isAsked(request)) archiveRequest(state, arbiter_, request);
    }
  }
}

void Plant::planSwaps() {
  // A handover for step K is asked for at K - margin - 1, the last step at which it can be: nothing is blocked until
  // then.
  const std::uint64_t at_step = master_.step() + scenario_.baton.margin_steps + 1;
  for (const HandoverRequest& request : scheduled_) {
    if (request.at_step != at_step) continue;
    arbiter_.request(request, master_.step());
    publishSwapActions();  // each by itself: the arbiter's ring holds what one request brings, not what sixty do
  }
  std::erase_if(scheduled_, [&](const HandoverRequest& request) { return request.at_step <= at_step; });
}

void Plant::refuseScheduled(const char* reason) {
  for (const HandoverRequest& request : scheduled_) {
    publishRefusal(arbiter_.planFor(request, master_.step()), reason);
  }
  scheduled_.clear();
}

void Plant::onSwapRequest(const msg::SwapRequest& message) {
  if (service_.isOver()) return;
  HandoverRequest request{.request_id = message.request_id(),
                          .target = memberCalled(message.target().c_str()),
                          .at_step = message.at_step(),
                          .force = message.force(),
                          .hard = message.hard()};
  const std::uint64_t step = master_.step();
  if (message.blend_ns() >= 0) {
    const double steps = static_cast<double>(message.blend_ns()) / static_cast<double>(scenario_.step_ns);
    request.blend_steps = static_cast<std::uint64_t>(std::llround(steps));
  }
  if (message.dry_run()) return onDryRun(request, message.target().c_str());
  const std::uint64_t earliest = step + scenario_.baton.margin_steps + 1;
  const bool can_wait = request.at_step > earliest && (master_.endStep() == 0 || request.at_step < master_.endStep());
  if (master_.isOver()) {
    publishRefusal(arbiter_.planFor(request, step), "the run is over");
  } else if (static_cast<double>(message.blend_ns()) * 1e-9 > kMaxBlend_s) {
    publishRefusal(arbiter_.planFor(request, step), "the blend is longer than 10 s");
  } else if (request.target == kBrake) {
    arbiter_.refuseUnknown(request.request_id, message.target().c_str(), step);
  } else if (can_wait && scheduled_.size() == scheduled_.capacity()) {
    // To plan it now would block all others until then.
    publishRefusal(arbiter_.planFor(request, step), "too many handovers wait for their time");
  } else if (can_wait) {
    scheduled_.push_back(request);  // asked for again when its time has come: until then nothing else is blocked
  } else {
    arbiter_.request(request, step);
  }
  publishSwapActions();
  proceed();
}

void Plant::onSwapAck(const msg::SwapAck& ack, const dds::RawSample& sample) {
  const int member = memberCalled(ack.controller().c_str());
  if (!speaksFor(member, sample)) return;
  if (ack.phase() == msg::SWAP_COMMIT) {
    arbiter_.commitAcknowledged(ack.plan_id(), member);
    return proceed();
  }
  Forecast forecast;
  const bool is_finite = readSequence(ack.effort(), scenario_.robot.size(), forecast.effort);
  forecast.is_ready = ack.ready() && is_finite;
  write(forecast.not_ready, "%s", ack.ready() && !is_finite ? "its forecast is not finite" : ack.reason().c_str());
  if (ack.phase() == msg::SWAP_FORECAST) {
    dry_runs_.forecastArrived(ack.plan_id(), member, forecast);
    return publishDryRuns();
  }
  arbiter_.prepareAcknowledged(ack.plan_id(), member, forecast);
  proceed();
}

void Plant::considerSwap() {
  if (master_.inputsHold() == Hold::kNone) {
    dryRunsKnowStep();
    arbiter_.consider(master_.step(), effort_, contact_.penetration > 0.0);
    publishSwapActions();
  }
  master_.awaitSwap(!isRealtime() && arbiter_.awaits(master_.step()));
}

// --- dry runs

void Plant::onDryRun(const HandoverRequest& request, const char* target) {
  if (request.target == kBrake) {
    DryRun unknown;
    unknown.plan = arbiter_.planFor(request, master_.step());
    write(unknown.verdict.objection, "no controller is called %.40s; see the controllers command", target);
    return publishDryRun(unknown);
  }
  if (const std::optional<HandoverPlan> plan = dry_runs_.ask(request, master_.step())) {
    publishPlan(*plan, plan->request_id, msg::SWAP_FORECAST);
  }
  if (master_.isOver()) {
    dry_runs_.dropAll("the run is over");
  } else if (master_.inputsHold() == Hold::kNone) {
    dryRunsKnowStep();
  }
  publishDryRuns();
}

void Plant::dryRunsKnowStep() {
  if (dry_runs_.isIdle()) return;
  dry_runs_.stepIsKnown(master_.step(), {.holder_effort = effort_, .in_contact = contact_.penetration > 0.0});
  publishDryRuns();
}

void Plant::publishDryRuns() {
  while (const std::optional<DryRun> answered = dry_runs_.takeAnswered()) publishDryRun(*answered);
}

// --- said

void Plant::publishSwapActions() {
  bool has_news = false;
  while (const std::optional<ArbiterAction> action = arbiter_.takeAction()) {
    const HandoverPlan& plan = action->plan;
    has_news = true;
    switch (action->kind) {
      case ArbiterAction::Kind::kPrepare:
        timing_.planned(plan.plan_id, steadyNow());
        decideSwap(plan);
        publishPlan(plan, plan.plan_id, msg::SWAP_PREPARE);
        break;
      case ArbiterAction::Kind::kCommit: publishPlan(plan, plan.plan_id, msg::SWAP_COMMIT); break;
      case ArbiterAction::Kind::kCancel: publishPlan(plan, plan.plan_id, msg::SWAP_CANCEL); break;
      case ArbiterAction::Kind::kRefused:
        if (plan.incoming != kBrake) {
          members_[static_cast<std::size_t>(plan.incoming)].refusal = {plan.decided_at_step, action->reason};
        }
        publishRefusal(plan, action->reason.data());
        service_.event(msg::SEVERITY_WARNING, "swap_refused",
                       (plan.incoming == kBrake ? "" : arbiter_.nameOf(plan.incoming) + ": ") + action->reason.data());
        break;
      case ArbiterAction::Kind::kDone:
        timing_.handedOver(plan.plan_id, steadyNow());
        if (completed_) publishDone(*completed_, "it lost the baton before its first command", {}, {});
        completed_ = plan;
        completed_reason_ = action->reason;
        service_.event(plan.plan_id == 0 ? msg::SEVERITY_WARNING : msg::SEVERITY_INFO, "swap",
                       arbiter_.nameOf(plan.incoming).empty() ? "the brake holds; " + std::string(action->reason.data())
                                                              : arbiter_.nameOf(plan.incoming) + " holds the baton");
        break;
    }
  }
  if (has_news) publishBaton();
}

/// What the scenario plans is in the scenario.
void Plant::decideSwap(const HandoverPlan& plan) {
  if (plan.request_id == 0) return;
  msg::Decision decision = decisionOf(msg::DECISION_SWAP, plan.incoming);
  decision.step(plan.decided_at_step);
  decision.at_step(plan.at_step);
  decision.force(plan.force);
  decision.hard(plan.hard);
  decision.blend_steps(plan.blend_steps);
  decision_out_.write(decision);
}

void Plant::publishPlan(const HandoverPlan& plan, std::uint64_t id, msg::SwapPhase phase) {
  msg::SwapPlan message;
  message.plan_id(id);
  message.phase(phase);
  message.outgoing(arbiter_.nameOf(plan.outgoing));
  message.incoming(arbiter_.nameOf(plan.incoming));
  message.forecast_step(plan.forecast_step);
  message.at_step(plan.at_step);
  message.blend_steps(plan.blend_steps);
  message.hard(plan.hard);
  plan_out_.write(message);
}

msg::SwapOutcome Plant::outcomeOf(const HandoverPlan& plan, const char* reason) const {
  msg::SwapOutcome outcome;
  outcome.request_id(plan.request_id);
  outcome.take(take_);
  outcome.plan_id(plan.plan_id);
  outcome.hard(plan.hard);
  outcome.outgoing(arbiter_.nameOf(plan.outgoing));
  outcome.incoming(arbiter_.nameOf(plan.incoming));
  outcome.decided_at_step(plan.decided_at_step);
  outcome.forecast_step(plan.forecast_step);
  outcome.at_step(plan.at_step);
  outcome.blend_steps(plan.blend_steps);
  assignSequence(plan.forecast_effort_step, outcome.forecast_effort_step());
  outcome.reason(reason);
  return outcome;
}

void Plant::publishRefusal(const HandoverPlan& plan, const char* reason) {
  outcome_out_.write(outcomeOf(plan, reason));
}

void Plant::publishDone(const HandoverPlan& plan, const char* reason, const JointVector& raw_step,
                        const JointVector& applied_step) {
  msg::SwapOutcome outcome = outcomeOf(plan, reason);
  outcome.done(true);
  assignSequence(raw_step, outcome.raw_effort_step());
  assignSequence(applied_step, outcome.applied_effort_step());
  // First: whoever sees the outcome finds how long it took.
  timing_out_.write(timing_.report(master_.step(), missed_));
  outcome_out_.write(outcome);
}

void Plant::publishDryRun(const DryRun& dry_run) {
  msg::SwapOutcome outcome = outcomeOf(dry_run.plan, dry_run.verdict.objection.data());
  outcome.dry_run(true);
  outcome.feasible(dry_run.verdict.isFeasible());
  assignSequence(dry_run.verdict.effort_step, outcome.forecast_effort_step());
  outcome_out_.write(outcome);
}

void Plant::publishBaton() {
  msg::BatonStatus status;
  status.holder(arbiter_.nameOf(arbiter_.holder()));
  if (const HandoverPlan* plan = arbiter_.planUnderWay()) {
    status.plan_id(plan->plan_id);
    status.request_id(plan->request_id);
    status.incoming(arbiter_.nameOf(plan->incoming));
    status.at_step(plan->at_step);
  }
  for (int member = 0; member < static_cast<int>(arbiter_.members().size()); ++member) {
    const Refusal& refusal = members_[static_cast<std::size_t>(member)].refusal;
    msg::BatonMember& one = status.members().emplace_back();
    one.name(arbiter_.nameOf(member));
    one.failed(arbiter_.hasFailed(member));
    one.refused_at_step(refusal.step);
    one.refusal(refusal.reason.data());
  }
  baton_out_.write(status);
}

// --- what it does to the arm

JointVector Plant::takeOver(std::uint64_t step) {
  // What the joints would have felt at this very step: the outgoing controller's torque, or, when it can give none,
  // what they felt before. The old blend, if one still runs, is part of it.
  const bool has_outgoing = master_.hasOutgoingCommand();
  const JointVector tau_old = has_outgoing ? arm_.blended(step, outgoing_effort_) : arm_.state().tau_applied;
  JointVector raw_step = tau_old - effort_;
  arm_.blendFrom(step, completed_->blend_steps, raw_step);
  publishReport(true);
  metered_plan_ = completed_->plan_id;
  meter_.start(step, std::max(completed_->blend_steps, scenario_.baton.blend_steps));
  return raw_step;
}

void Plant::measureStep(std::uint64_t step, const JointVector& tau_before, const JointVector& q_before) {
  if (!meter_.isRunning()) return;
  meter_.add({.tau_before = tau_before,
              .tau = arm_.state().tau_applied,
              .residual = arm_.residual(step),
              .dq = arm_.state().q - q_before,
              .f_e = contact_.h_e.head<3>()});
  if (!meter_.isRunning()) publishReport(false);
}

void Plant::publishReport(bool cut_short) {
  if (cut_short && !meter_.isRunning()) return;
  meter_.stop();
  const HandoverMeasure& measure = meter_.measure();
  msg::SwapReport report;
  report.plan_id(metered_plan_);
  report.take(take_);
  report.at_step(measure.at_step);
  report.steps(measure.steps);
  report.cut_short(cut_short);
  assignSequence(measure.max_effort_rate, report.max_effort_rate());
  report.rate_limit_hits(measure.rate_limit_hits);
  report.peak_force_deviation(measure.peak_force_deviation);
  report.blend_energy(measure.blend_energy);
  report_out_.write(report);
}

}  // namespace baton
