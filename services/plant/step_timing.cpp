#include "step_timing.hpp"

#include "runtime/timing.hpp"

namespace baton {

void StepTiming::opened(std::int64_t now_ns, bool runs) noexcept {
  if (opened_ns_) period_ns_.record(now_ns - *opened_ns_);
  opened_ns_ = runs ? std::optional(now_ns) : std::nullopt;
}

void StepTiming::ticked(std::int64_t lateness_ns, bool is_old) noexcept {
  jitter_ns_.record(lateness_ns);
  age_steps_ = is_old ? age_steps_ + 1 : 0;
  command_age_.record(age_steps_);
}

msg::TimingStatus StepTiming::report(std::uint64_t step, std::uint64_t missed_steps) const {
  msg::TimingStatus status;
  status.step(step);
  status.period(timeSpread(period_ns_));
  status.jitter(timeSpread(jitter_ns_));
  status.command_age(stepSpread(command_age_));
  status.missed_steps(missed_steps);
  return status;
}

}  // namespace baton
