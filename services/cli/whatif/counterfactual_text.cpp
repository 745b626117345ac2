// The counterfactual for a person, and as JSON.
#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "base/plural.hpp"
#include "counterfactual.hpp"
#include "messages/parameters.hpp"
#include "report/theory_tools.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

constexpr std::size_t kShownTenures = 24;

Json toJson(const ParameterValue& value) {
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  return std::get<std::vector<double>>(value);
}

Json toJson(const Gap& gap) {
  Json json{{"steps", gap.steps}, {"first_step", gap.steps > 0 ? Json(gap.first_step) : Json()}};
  if (gap.steps > 0 && !gap.reason.empty()) json["reason"] = gap.reason;
  return json;
}

std::string jointName(std::size_t i) { return fmt::format("tau{}", i + 1); }

Json toJson(const EffortDifference& difference, const Scenario& scenario) {
  Json joints = Json::array();
  for (std::size_t i = 0; i < difference.joints().size(); ++i) {
    const EffortDifference::Joint& joint = difference.joints()[i];
    joints.push_back({{"name", jointName(i)},
                      {"unit", theory::effortUnit(scenario.robot, static_cast<int>(i))},
                      {"rms", difference.rms(i)},
                      {"largest", joint.largest},
                      {"largest_at_step", joint.largest_at_step}});
  }
  const auto first = difference.firstDifferentStep();
  return {{"steps", difference.steps()},
          {"exact", difference.isExact()},
          {"different_steps", difference.differentSteps()},
          {"first_different_step", first ? Json(*first) : Json()},
          {"joints", joints}};
}

std::string instant(const EffortDifference::Joint& joint, const Scenario& scenario) {
  if (joint.largest == 0.0) return "-";
  const std::uint64_t step = joint.largest_at_step;
  return fmt::format("{} ({:.4f} s)", step, static_cast<double>(step) * scenario.stepSeconds());
}

/// A heading, and a line for each joint unless there is nothing to tell apart.
void add(std::string& text, const std::string& heading, const EffortDifference& difference, const Scenario& scenario) {
  text += heading;
  if (difference.steps() == 0) {
    text += ": nothing to compare\n";
    return;
  }
  if (difference.isExact()) {
    text += ": exactly as recorded\n";
    return;
  }
  text += "\n";
  for (std::size_t i = 0; i < difference.joints().size(); ++i) {
    const EffortDifference::Joint& joint = difference.joints()[i];
    const std::string unit = theory::effortUnit(scenario.robot, static_cast<int>(i));
    text += fmt::format("  {:<54}{:>12.4e}{:>12.4e}  {}\n", jointName(i) + " [" + unit + "]", difference.rms(i),
                        joint.largest, instant(joint, scenario));
  }
}

std::string headingOf(const Tenure& tenure, const Counterfactual& made) {
  const std::string who = tenure.holder.empty() ? "the brake" : tenure.holder;
  const bool holds = !made.wish.in_shadow && (made.wish.as.empty() || made.wish.as == tenure.holder);
  return fmt::format("steps {} to {}, held by {}{}", tenure.first_step, tenure.last_step, who,
                     holds ? "" : " (the law stands by)");
}

void addGap(std::string& text, const Gap& gap, const std::string& what) {
  if (gap.steps == 0) return;
  text += fmt::format("{} {}, first step {}{}\n", counted(gap.steps, "step"), what, gap.first_step,
                      gap.reason.empty() ? "" : ": " + gap.reason);
}

std::string verdictOf(const Counterfactual& made) {
  if (made.overall.isExact()) return "reproduces the recorded torque exactly\n";
  if (!made.is_itself || made.wish.in_shadow || made.overall.steps() == 0) return "";
  std::string text =
      fmt::format("does not reproduce the recorded torque: {} of {} steps differ, first step {}\n",
                  made.overall.differentSteps(), made.overall.steps(), *made.overall.firstDifferentStep());
  if (made.has_faulty_commands) text += "the scenario's faults alter what " + made.wish.as + " says\n";
  return text;
}

}  // namespace

Json toJson(const Counterfactual& made) {
  Json parameters = Json::object();
  for (const auto& [name, value] : made.parameters) parameters[name] = toJson(value);
  Json tenures = Json::array();
  for (const Tenure& tenure : made.tenures) {
    tenures.push_back({{"holder", tenure.holder},
                       {"first_step", tenure.first_step},
                       {"last_step", tenure.last_step},
                       {"difference", toJson(tenure.difference, made.scenario)}});
  }
  return {{"law", made.law},
          {"as", made.wish.as.empty() ? Json() : Json(made.wish.as)},
          {"place", placeOf(made.wish)},
          {"parameters", parameters},
          {"changes", made.changes},
          {"run_hash", std::to_string(made.run_hash)},
          {"complete", made.is_complete},
          {"cut", made.cut},
          {"first_step", made.first_step},
          {"steps", made.steps},
          {"without_inputs", toJson(made.without_inputs)},
          {"without_effort", toJson(made.without_effort)},
          {"without_recorded", toJson(made.without_recorded)},
          {"with_other_inputs", toJson(made.with_other_inputs)},
          {"exact", made.overall.isExact()},
          {"difference", toJson(made.overall, made.scenario)},
          {"tenures", tenures}};
}

std::string toText(const Counterfactual& made) {
  const Scenario& scenario = made.scenario;
  std::string text = fmt::format("{}, {}\n", made.law, placeOf(made.wish));
  text += fmt::format("with {}", toText(made.parameters));
  if (made.changes > 0) {
    text += fmt::format("; changed {} on the way, as recorded",
                        made.changes == 1 ? std::string("once") : std::to_string(made.changes) + " times");
  }
  text += fmt::format("\n{}, {:.4f} s{}\n", counted(made.steps, "step"),
                      static_cast<double>(made.steps - 1) * scenario.stepSeconds(),
                      made.cut.empty() ? "" : ", cut off: " + made.cut);
  text += fmt::format("{:<56}{:>12}{:>12}  {}\n", "its effort less the recorded one", "rms", "largest", "at step");
  add(text,
      made.isOfOneController()
          ? fmt::format("the {} steps in which {} held the baton", made.overall.steps(), made.wish.as)
          : fmt::format("all {} steps", made.overall.steps()),
      made.overall, scenario);
  for (std::size_t i = 0; i < std::min(made.tenures.size(), kShownTenures) && made.tenures.size() > 1; ++i) {
    add(text, headingOf(made.tenures[i], made), made.tenures[i].difference, scenario);
  }
  if (made.tenures.size() > kShownTenures) {
    text += fmt::format("and {}: --json has them all\n", counted(made.tenures.size() - kShownTenures, "more holder"));
  }
  addGap(text, made.without_inputs, "not recorded whole: the law was not asked");
  addGap(text, made.without_effort, "for which the law has no effort");
  addGap(text, made.without_recorded, "without a recorded effort: not compared");
  addGap(text, made.with_other_inputs, "that the holder computed from other bytes than are recorded");
  return text + verdictOf(made);
}

}  // namespace baton
