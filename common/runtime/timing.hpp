/// How times were distributed: histograms to messages, and messages to the JSON that result.json and `baton status
/// --json` carry.
#pragma once

#include <nlohmann/json.hpp>

#include "msg/sim.h"
#include "time/histogram.hpp"

namespace baton {

[[nodiscard]] msg::TimeSpread timeSpread(const Histogram& times_ns);
[[nodiscard]] msg::StepSpread stepSpread(const Histogram& steps);

/// {"period_us": {"count", "mean", "p50", "p99", "p999", "max"}, "jitter_us": ..., "command_age_steps": ..., "missed",
/// "handover_us": ...}; null stands for what has no values, as jitter and age have in lockstep.
[[nodiscard]] nlohmann::ordered_json toJson(const msg::TimingStatus& timing);

}  // namespace baton
