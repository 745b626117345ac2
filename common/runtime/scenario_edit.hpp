/// Changes to the text of a scenario, by path: "controllers.impedance.parameters.kp",
/// "environment.walls.0.damping_N_s_per_m". A part of a path is a key, or in a list the entry's place (from 0) or its
/// `name`. What comes out is checked like any scenario when it is read.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace baton {

/// Path and value, the value as YAML text: "300", "[1, 2, 3]", "{at_s: 1, to: force}".
using ScenarioSetting = std::pair<std::string, std::string>;

/// Splits "path=value". Throws UsageError when it is not of that form.
[[nodiscard]] ScenarioSetting parseSetting(const std::string& text);

/// Keys that are missing in a map are added. Comments are lost. Throws UsageError for a path that leads nowhere and for
/// text that is not YAML.
[[nodiscard]] std::string editScenario(const std::string& text, const std::vector<ScenarioSetting>& settings);

/// Without those entries of a list that `keeps(place)` does not want.
[[nodiscard]] std::string keepInScenario(const std::string& text, const std::string& key,
                                         const std::function<bool(std::size_t)>& keeps);

/// More entries, as YAML text, at the end of a list of the scenario, which is made when it is missing.
[[nodiscard]] std::string appendToScenario(const std::string& text, const std::string& key,
                                           const std::vector<std::string>& entries);

/// The scenario with a controller that is new, has another law (its parameters are the law's then), or other
/// parameters.
/// @param law         empty: as it stands in the scenario.
/// @param parameters  "name=value" in YAML, each on a line.
[[nodiscard]] std::string withController(const std::string& text, const std::string& name, const std::string& law,
                                         const std::string& parameters);

}  // namespace baton
