/// The baton's part of a scenario: who may hold it when, and how it is handed over.
#include <algorithm>
#include <cmath>

#include "runtime/scenario.hpp"
#include "runtime/scenario_parts.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxSwaps = 10'000;
constexpr std::size_t kMaxFailures = 1'000;
constexpr std::size_t kMaxStops = 1'000;
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
    config.margin_steps = static_cast<std::uint64_t>(
        baton.integerOr("margin_steps", 1, 1000, static_cast<std::int64_t>(config.margin_steps)));
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

void readFailures(const YamlMap& map, Scenario& scenario) {
  const auto node = map.find("failures");
  if (!node) return;
  for (const YamlNode& item : node->list(0, kMaxFailures)) {
    const YamlMap given = item.map({"at_s", "controller", "commanded", "returns_at_s", "restarted"});
    PlannedFailure failure{.at_step = {},
                           .controller = readMember(given["controller"], scenario),
                           .commanded = given.booleanOr("commanded", true),
                           .returns_at_step = {},
                           .restarted = given.booleanOr("restarted", false)};
    const auto at_s = given.find("at_s"), returns_at_s = given.find("returns_at_s");
    if (at_s) failure.at_step = readSteps(*at_s, scenario);
    if (returns_at_s) failure.returns_at_step = readSteps(*returns_at_s, scenario);
    if (given.has("commanded") && !at_s) given["commanded"].fail("expected at_s beside it, found none");
    if (given.has("restarted") && !returns_at_s) given["restarted"].fail("expected returns_at_s beside it, found none");
    if (returns_at_s && *failure.returns_at_step < failure.at_step.value_or(0)) {
      returns_at_s->refuse("a time not before at_s");
    }
    for (const PlannedFailure& other : scenario.failures) {
      if (other.at_step && (!failure.at_step || *failure.at_step < *other.at_step)) {
        at_s.value_or(item).refuse("failures in the order of their times, those without one first");
      }
      const bool is_over = other.returns_at_step && failure.at_step && *other.returns_at_step <= *failure.at_step;
      if (other.controller == failure.controller && !is_over) {
        given["controller"].refuse("a controller that has returned from the failure before");
      }
    }
    scenario.failures.push_back(failure);
  }
}

void readStops(const YamlMap& map, Scenario& scenario) {
  const auto node = map.find("stops");
  if (!node) return;
  for (const YamlNode& item : node->list(0, kMaxStops)) {
    const YamlMap given = item.map({"decided_at_s", "at_s"});
    const PlannedStop stop{readSteps(given["decided_at_s"], scenario), readSteps(given["at_s"], scenario)};
    if (stop.at_step <= stop.decided_at_step) given["at_s"].refuse("a time after decided_at_s");
    if (!scenario.stops.empty() && stop.decided_at_step < scenario.stops.back().decided_at_step) {
      given["decided_at_s"].refuse("a time not before that of the stop before");
    }
    scenario.stops.push_back(stop);
  }
}

namespace {

PlannedSwap readSwap(const YamlMap& map, const Scenario& scenario) {
  PlannedSwap swap{.at_step = readSteps(map["at_s"], scenario),
                   .to = readMember(map["to"], scenario),
                   .force = map.booleanOr("force", false),
                   .hard = map.booleanOr("hard", false),
                   .blend_steps = {},
                   .expect = SwapExpectation::kDone};
  if (const auto expect = map.find("expect")) {
    swap.expect = expect->oneOf<SwapExpectation>(
        {{"done", SwapExpectation::kDone}, {"refused", SwapExpectation::kRefused}, {"any", SwapExpectation::kAny}});
  }
  if (const auto blend_s = map.find("blend_s")) {
    if (swap.hard) blend_s->fail("expected none beside hard: true, which has no blend");
    swap.blend_steps =
        static_cast<std::uint64_t>(std::llround(blend_s->number({0.0, kMaxBlend_s, "s"}) / scenario.stepSeconds()));
  }
  return swap;
}

}  // namespace

void readSwaps(const YamlMap& map, Scenario& scenario) {
  const auto node = map.find("swaps");
  if (!node) return;
  const BatonConfig& baton = scenario.baton;
  const auto in_words = [&](std::uint64_t step) {
    return "step " + std::to_string(step) + " (" + shownNumber(static_cast<double>(step) * scenario.stepSeconds()) +
           " s)";
  };
  std::string holder = scenario.active;
  for (const YamlNode& item : node->list(0, kMaxSwaps)) {
    const YamlMap given = item.map({"at_s", "to", "force", "hard", "blend_s", "expect"});
    const YamlNode at_s = given["at_s"];
    const PlannedSwap swap = readSwap(given, scenario);
    std::uint64_t earliest = baton.margin_steps + 2;
    std::string why = ", margin_steps + 2";
    const bool is_free = swap.expect == SwapExpectation::kAny;  // as an operator is, who may ask for what cannot be
    if (is_free) {
      earliest = baton.margin_steps + 1;
      why = ", margin_steps + 1";
    }
    if (!scenario.swaps.empty()) {
      const PlannedSwap& before = scenario.swaps.back();
      const std::uint64_t blend_steps = before.hard ? 0 : before.blend_steps.value_or(baton.blend_steps);
      const std::uint64_t apart = is_free ? 0 : std::max(2 * baton.margin_steps + 3, blend_steps);
      if (before.at_step + apart >= earliest) {
        earliest = before.at_step + apart;
        why = is_free ? ", that of the swap before"
                      : ": the swap before must be over, which takes its blend and more than 2 margin_steps + 2";
      }
    }
    if (swap.at_step < earliest) at_s.refuse("a time not before " + in_words(earliest) + why);
    if (scenario.end_step > 0 && swap.at_step >= scenario.end_step) {
      at_s.refuse("a time before the end of the run, " + in_words(scenario.end_step));
    }
    // Who holds the baton behind a failure, or behind what may go either way, nobody knows beforehand.
    if (is_free || !scenario.failures.empty()) holder.clear();
    if (swap.expect == SwapExpectation::kDone) {
      const bool is_known = !holder.empty() && swap.to == holder;
      if (is_known) given["to"].refuse("a controller that does not hold the baton already");
      holder = swap.to;
    }
    scenario.swaps.push_back(swap);
  }
}

}  // namespace baton
