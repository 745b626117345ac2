/// What was measured, as a table for people and as JSON: medians over the rounds, ratios of what ran in the same round,
/// targets and whether they are reached.
#pragma once

#include <iosfwd>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cases.hpp"

namespace baton::bench {

/// Every round's measurement of every case that was run.
using Results = std::map<std::string, std::vector<Measurement>>;

struct Plan {
  int rounds = 0;
  int steps = 0;
  std::vector<Case> cases;
};

/// {"rounds", "steps", "machine", "build",
///  "cases": [{"name", "hops", "transport", "recorded", "standbys", "cells", "processes", and "p50_us", "p99_us",
///             "steps_per_s", "startup_s", each {"median", "rounds": [...]}}],
///  "resident_MB": {process: ...}, "comparisons": [{"name", "of", "against", "ratio", "target", "reached"}],
///  "limits": [{"name", "unit", "value", "target", "reached"}]}; what was not measured is null.
[[nodiscard]] nlohmann::ordered_json toJson(const Plan& plan, const Results& results);

/// The same for a person.
void printTable(const nlohmann::ordered_json& report, std::ostream& out);

}  // namespace baton::bench
