/// How a handover went and what it did to the arm, as the JSON that results and `baton swap --json` carry.
#pragma once

#include <nlohmann/json.hpp>

#include "msg/swap.h"

namespace baton {

/// {"steps", "cut_short", "max_effort_rate", "rate_limit_hits", "peak_force_deviation_N", "blend_energy_J"}
[[nodiscard]] nlohmann::ordered_json toJson(const msg::SwapReport& report);

/// {"done", "outgoing", "incoming", "request_id", "plan_id", "decided_at_step", "at_step", "hard", "blend_steps",
/// "raw_effort_step", "applied_effort_step", "reason"}; efforts in N m or N.
[[nodiscard]] nlohmann::ordered_json toJson(const msg::SwapOutcome& swap);

}  // namespace baton
