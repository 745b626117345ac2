/// How soon handovers took effect, as a table and as JSON, against what is aimed at.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "handovers.hpp"

namespace baton::bench {

using SwapResults = std::vector<std::pair<SwapCase, Handovers>>;

/// {"swaps", "cores", "cases": [{"name", "step_ms", "margin_steps", "done", "refused", "refusal", "lost",
/// "missed_steps",
///  "asked_to_effect_ms": {"p50", "p99", "max"}, "decided_to_effect_ms", "steps", "target": {"quantity", "at_most",
///  "value", "reached"}}]}; null for what no handover took place for.
[[nodiscard]] nlohmann::ordered_json toJson(int swaps, const SwapResults& results);

/// The same for a person.
void printTable(const nlohmann::ordered_json& report, std::ostream& out);

}  // namespace baton::bench
