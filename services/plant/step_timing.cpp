#include "step_timing.hpp"

namespace baton {
namespace {

double microseconds(double ns) { return ns * 1e-3; }

msg::TimeSpread timeSpread(const Histogram& times_ns) {
  const auto quantile = [&](double p) { return microseconds(static_cast<double>(times_ns.quantile(p))); };
  msg::TimeSpread spread;
  spread.count(times_ns.count());
  spread.mean_us(microseconds(times_ns.mean()));
  spread.p50_us(quantile(0.5));
  spread.p99_us(quantile(0.99));
  spread.p999_us(quantile(0.999));
  spread.max_us(microseconds(static_cast<double>(times_ns.max())));
  return spread;
}

msg::StepSpread stepSpread(const Histogram& steps) {
  const auto quantile = [&](double p) { return static_cast<std::uint64_t>(steps.quantile(p)); };
  msg::StepSpread spread;
  spread.count(steps.count());
  spread.mean(steps.mean());
  spread.p50(quantile(0.5));
  spread.p99(quantile(0.99));
  spread.p999(quantile(0.999));
  spread.max(static_cast<std::uint64_t>(steps.max()));
  return spread;
}

}  // namespace

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
