#include "runtime/timing_json.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

Json toJson(const msg::TimeSpread& spread) {
  if (spread.count() == 0) return nullptr;
  return {{"count", spread.count()}, {"mean", spread.mean_us()}, {"p50", spread.p50_us()},
          {"p99", spread.p99_us()},  {"p999", spread.p999_us()}, {"max", spread.max_us()}};
}

Json toJson(const msg::StepSpread& spread) {
  if (spread.count() == 0) return nullptr;
  return {{"count", spread.count()}, {"mean", spread.mean()}, {"p50", spread.p50()},
          {"p99", spread.p99()},     {"p999", spread.p999()}, {"max", spread.max()}};
}

}  // namespace

Json toJson(const msg::TimingStatus& timing) {
  return {{"period_us", toJson(timing.period())},
          {"jitter_us", toJson(timing.jitter())},
          {"command_age_steps", toJson(timing.command_age())},
          {"missed", timing.missed_steps()}};
}

}  // namespace baton
