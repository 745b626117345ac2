/// What a handover did to the arm, as the JSON that result.json and `baton swap --json` carry.
#pragma once

#include <nlohmann/json.hpp>

#include "msg/swap.h"

namespace baton {

/// {"steps", "cut_short", "max_effort_rate", "rate_limit_hits", "peak_force_deviation_N", "blend_energy_J"}
[[nodiscard]] nlohmann::ordered_json toJson(const msg::SwapReport& report);

}  // namespace baton
