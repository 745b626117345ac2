/// The baton's part of a scenario: who may hold it when, and how it is handed over.
#include <algorithm>
#include <cmath>

#include "runtime/scenario.hpp"
#include "runtime/scenario_parts.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxSwaps = 10'000;
const NumberRange kEffortRate{0.0, 1e9, "N m/s or N/s", true};

/// What an arm with joints of 87 N m is allowed to command: 1000 N m/s (Franka Emika, FCI). A joint with a limit of its
/// own gets its share of that, one without the whole.
JointVector defaultEffortRate(const RobotModel& robot) {
  constexpr double kRate = 1000.0;
  constexpr double kOfLimit = 87.0;
  JointVector rate(robot.size());
  for (int i = 0; i < robot.size(); ++i) {
    const double limit = robot.joints[static_cast<std::size_t>(i)].effort_limit;
    rate(i) = std::isfinite(limit) ? kRate * limit / kOfLimit : kRate;
  }
  return rate;
}

}  // namespace

void readBaton(const YamlMap& map, Scenario& scenario) {
  double blend_s = 0.1;
  scenario.baton.max_effort_rate = defaultEffortRate(scenario.robot);
  // At 1 kHz a request then takes effect within 5 ms: it waits for the next step, the margin, and no more.
  if (scenario.mode == SimMode::kRealtime) scenario.baton.margin_steps = 3;
  if (const auto node = map.find("baton")) {
    const YamlMap baton =
        node->map({"margin_steps", "blend_s", "max_effort_step", "max_effort_rate", "max_command", "fallback"});
    BatonConfig& config = scenario.baton;
    config.margin_steps = static_cast<std::uint64_t>(baton.integerOr("margin_steps", 1, 1000, config.margin_steps));
    config.max_effort_step =
        baton.numberOr("max_effort_step", {0.0, 1e9, "N m or N", true}, scenario.baton.max_effort_step);
    config.max_command = baton.numberOr("max_command", {0.0, 1e9, "N m or N", true}, config.max_command);
    if (const auto rate = baton.find("max_effort_rate")) {
      config.max_effort_rate = readJointsOrOne(*rate, kEffortRate, scenario.robot.size());
    }
    blend_s = baton.numberOr("blend_s", {0.0, kMaxBlend_s, "s"}, blend_s);
    if (const auto fallback = baton.find("fallback")) {
      for (const YamlNode& item : fallback->list(0, kMaxControllers)) {
        const std::string name = readMember(item, scenario);
        if (std::find(config.fallback.begin(), config.fallback.end(), name) != config.fallback.end()) {
          item.refuse("each controller once");
        }
        config.fallback.push_back(name);
      }
    }
  }
  // The length of a fade is not an instant of the run: the nearest whole number of steps will do.
  scenario.baton.blend_steps = static_cast<std::uint64_t>(std::llround(blend_s / scenario.stepSeconds()));
}

void readSwaps(const YamlMap& map, Scenario& scenario) {
  const auto node = map.find("swaps");
  if (!node) return;
  const BatonConfig& baton = scenario.baton;
  const std::uint64_t apart = std::max(2 * baton.margin_steps + 3, baton.blend_steps);
  const auto in_words = [&](std::uint64_t step) {
    return "step " + std::to_string(step) + " (" + shownNumber(static_cast<double>(step) * scenario.stepSeconds()) +
           " s)";
  };
  std::string holder = scenario.active;
  for (const YamlNode& item : node->list(0, kMaxSwaps)) {
    const YamlMap map_of_swap = item.map({"at_s", "to", "expect"});
    const YamlNode at_s = map_of_swap["at_s"];
    PlannedSwap swap{readSteps(at_s, scenario), readMember(map_of_swap["to"], scenario)};
    if (const auto expect = map_of_swap.find("expect")) {
      swap.is_to_be_refused = expect->oneOf<bool>({{"done", false}, {"refused", true}});
    }
    if (scenario.swaps.empty()) {
      const std::uint64_t earliest = baton.margin_steps + 2;
      if (swap.at_step < earliest) at_s.refuse("a time not before " + in_words(earliest) + ", margin_steps + 2");
    } else if (const std::uint64_t before = scenario.swaps.back().at_step; swap.at_step < before + apart) {
      at_s.refuse("a time not before " + in_words(before + apart) +
                  ": the swap before must be over, which takes its blend and more than 2 margin_steps + 2");
    }
    if (scenario.end_step > 0 && swap.at_step >= scenario.end_step) {
      at_s.refuse("a time before the end of the run, " + in_words(scenario.end_step));
    }
    if (!swap.is_to_be_refused) {
      if (swap.to == holder) map_of_swap["to"].refuse("a controller that does not hold the baton already");
      holder = swap.to;
    }
    scenario.swaps.push_back(swap);
  }
}

}  // namespace baton
