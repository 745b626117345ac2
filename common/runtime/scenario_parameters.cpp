/// Parameters of laws in a scenario: those a controller starts with, and those that change on the way.
#include <algorithm>
#include <map>

#include "runtime/scenario.hpp"
#include "runtime/scenario_parts.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxChanges = 4096;  // each has a law made for it before the run begins

ParameterValue readParameter(const YamlNode& node, bool is_choice) {
  if (is_choice) return node.text();
  if (!node.isList()) return std::vector<double>{node.number()};
  std::vector<double> values;
  for (const YamlNode& item : node.list(0, 64)) values.push_back(item.number());
  return values;
}

struct Read {
  PlannedChange planned;
  YamlNode node;
};

Read readChange(const YamlNode& node, Scenario& scenario) {
  const YamlMap map = node.map({"at_s", "controller", "set"});
  PlannedChange planned;
  planned.change.is_planned = true;
  planned.change.at_step = readSteps(map["at_s"], scenario);
  if (scenario.end_step > 0 && planned.change.at_step >= scenario.end_step) {
    // A run that is cut short, to go on from there, keeps its plans.
    scenario.warnings.push_back(map["at_s"].place() + "the run is over before that change");
  }
  planned.controller = readMember(map["controller"], scenario);
  const LawInfo& law = findLaw(scenario.controller(planned.controller).law);
  planned.change.set = readParameters(map["set"], law, scenario.robot.size());
  if (planned.change.set.empty()) map["set"].fail("expected a parameter to change, found none");
  return {planned, map["set"]};
}

}  // namespace

ParameterValues readParameters(const YamlNode& node, const LawInfo& law, int n) {
  ParameterValues given;
  for (const auto& [name, value] : node.entries()) {
    const auto is_named = [&name = name](const ParameterSpec& spec) { return spec.name == name; };
    const auto spec = std::find_if(law.parameters.begin(), law.parameters.end(), is_named);
    const bool is_known = spec != law.parameters.end();
    const ParameterValue read =
        is_known ? readParameter(value, spec->size == ParameterSize::kChoice) : ParameterValue();
    // Each by itself, so that a message can name its line.
    const ParameterValues whole = at(value, [&, &key = name] {
      return completeParameters(law.parameters, {{key, read}}, n);
    });
    given[name] = whole.at(name);
  }
  return given;
}

void readChanges(const YamlMap& map, Scenario& scenario) {
  const auto node = map.find("changes");
  if (!node) return;
  std::vector<Read> all;
  for (const YamlNode& item : node->list(0, kMaxChanges)) all.push_back(readChange(item, scenario));
  std::stable_sort(all.begin(), all.end(),
                   [](const Read& a, const Read& b) { return a.planned.change.at_step < b.planned.change.at_step; });
  // A law may refuse parameters that do not go together, one by one as they come.
  std::map<std::string, ParameterValues> in_force;
  for (const auto& [planned, set] : all) {
    const ControllerConfig& controller = scenario.controller(planned.controller);
    ParameterValues& values = in_force.try_emplace(controller.name, controller.parameters).first->second;
    for (const auto& [name, value] : planned.change.set) values[name] = value;
    at(set, [&, &now = values] { (void)makeLaw(controller.law, scenario.robot, now); });
    scenario.changes.push_back(planned);
  }
}

}  // namespace baton
