#include "runtime/timing.hpp"

namespace baton {
namespace {

double microseconds(double ns) { return ns * 1e-3; }

nlohmann::ordered_json toJson(const msg::TimeSpread& spread) {
  if (spread.count() == 0) return nullptr;
  return {{"count", spread.count()}, {"mean", spread.mean_us()}, {"p50", spread.p50_us()},
          {"p99", spread.p99_us()},  {"p999", spread.p999_us()}, {"max", spread.max_us()}};
}

nlohmann::ordered_json toJson(const msg::StepSpread& spread) {
  if (spread.count() == 0) return nullptr;
  return {{"count", spread.count()}, {"mean", spread.mean()}, {"p50", spread.p50()},
          {"p99", spread.p99()},     {"p999", spread.p999()}, {"max", spread.max()}};
}

}  // namespace

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

nlohmann::ordered_json toJson(const msg::TimingStatus& timing) {
  return {{"period_us", toJson(timing.period())},
          {"jitter_us", toJson(timing.jitter())},
          {"command_age_steps", toJson(timing.command_age())},
          {"missed", timing.missed_steps()},
          {"handover_us", toJson(timing.handover())}};
}

}  // namespace baton
