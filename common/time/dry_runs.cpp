#include "time/dry_runs.hpp"

#include <algorithm>

namespace baton {
namespace {

void refuse(DryRun& one, const char* reason) {
  write(one.verdict.objection, "%s", reason);
  one.is_answered = true;
}

}  // namespace

std::optional<HandoverPlan> DryRuns::ask(const HandoverRequest& request, std::uint64_t open_step) {
  DryRun one;
  one.plan = arbiter_.planFor(request, open_step);
  const ReasonText objection = arbiter_.objectionTo(one.plan, open_step);
  one.plan.forecast_step = open_step;
  const auto open = std::count_if(runs_.begin(), runs_.end(), [](const DryRun& run) { return !run.is_answered; });
  if (objection.front() != '\0') {
    refuse(one, objection.data());
  } else if (static_cast<std::size_t>(open) >= kMaxOpen) {
    refuse(one, "too many dry runs wait for an answer");
  }
  runs_.push_back(one);
  return one.is_answered ? std::nullopt : std::optional(one.plan);
}

void DryRuns::judgeIfKnown(DryRun& one) const {
  if (one.is_answered || !one.forecast || !one.step) return;
  const ArbiterMember& incoming = arbiter_.members()[static_cast<std::size_t>(one.plan.incoming)];
  one.verdict = judge(incoming, *one.forecast, *one.step, arbiter_.maxEffortStep(), one.plan.force);
  one.is_answered = true;
}

void DryRuns::forecastArrived(std::uint64_t request_id, int member, const Forecast& forecast) {
  for (DryRun& one : runs_) {
    if (one.plan.request_id != request_id || one.plan.incoming != member || one.forecast) continue;
    one.forecast = forecast;
    judgeIfKnown(one);
  }
}

void DryRuns::stepIsKnown(std::uint64_t step, const ForecastStep& known) {
  for (DryRun& one : runs_) {
    if (one.plan.forecast_step == step && !one.step) {
      one.step = known;
      judgeIfKnown(one);
    }
    if (!one.is_answered && step > one.plan.forecast_step + kPatience_steps) refuse(one, "it gave no forecast");
  }
}

void DryRuns::memberFailed(int member) {
  for (DryRun& one : runs_) {
    if (!one.is_answered && one.plan.incoming == member) refuse(one, "it has failed");
  }
}

void DryRuns::dropAll(const char* reason) {
  for (DryRun& one : runs_) {
    if (!one.is_answered) refuse(one, reason);
  }
}

std::optional<DryRun> DryRuns::takeAnswered() {
  const auto found = std::find_if(runs_.begin(), runs_.end(), [](const DryRun& one) { return one.is_answered; });
  if (found == runs_.end()) return std::nullopt;
  const DryRun answered = *found;
  runs_.erase(found);
  return answered;
}

}  // namespace baton
