#include "step_timing.hpp"

#include "runtime/timing.hpp"

namespace baton {

void StepTiming::opened(std::int64_t now_ns, bool runs) noexcept {
  if (opened_ns_) period_ns_.record(now_ns - *opened_ns_);
  opened_ns_ = runs ? std::optional(now_ns) : std::nullopt;
  if (!runs) plan_ = 0;
}

void StepTiming::ticked(std::int64_t lateness_ns, bool is_old) noexcept {
  jitter_ns_.record(lateness_ns);
  age_steps_ = is_old ? age_steps_ + 1 : 0;
  command_age_.record(age_steps_);
}

void StepTiming::planned(std::uint64_t plan_id, std::int64_t now_ns) noexcept {
  plan_ = opened_ns_ ? plan_id : 0;
  planned_ns_ = now_ns;
}

void StepTiming::handedOver(std::uint64_t plan_id, std::int64_t now_ns) noexcept {
  if (plan_id == 0 || plan_id != plan_) return;
  last_plan_ = plan_id;
  last_handover_ns_ = now_ns - planned_ns_;
  handover_ns_.record(last_handover_ns_);
}

msg::TimingStatus StepTiming::report(std::uint64_t step, std::uint64_t missed_steps) const {
  msg::TimingStatus status;
  status.step(step);
  status.period(timeSpread(period_ns_));
  status.jitter(timeSpread(jitter_ns_));
  status.command_age(stepSpread(command_age_));
  status.missed_steps(missed_steps);
  status.handover(timeSpread(handover_ns_));
  status.last_handover_plan(last_plan_);
  status.last_handover_us(static_cast<double>(last_handover_ns_) * 1e-3);
  return status;
}

}  // namespace baton
