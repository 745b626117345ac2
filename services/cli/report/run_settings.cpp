#include "run_settings.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "control/law.hpp"

namespace baton {
namespace {

std::string valueText(const ParameterValue& value) {
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  const auto& numbers = std::get<std::vector<double>>(value);
  const bool are_equal = std::all_of(numbers.begin(), numbers.end(), [&](double x) { return x == numbers.front(); });
  return are_equal && !numbers.empty() ? fmt::format("{:g}", numbers.front())
                                       : fmt::format("({:g})", fmt::join(numbers, ", "));
}

/// Gains always, what only switches something when it is not at its default.
std::string controllerText(const ControllerConfig& controller) {
  std::string text = controller.law + ":";
  for (const ParameterSpec& spec : findLaw(controller.law).parameters) {
    const ParameterValue& value = controller.parameters.at(spec.name);
    const bool is_switch = spec.size == ParameterSize::kChoice;
    if (is_switch && std::get<std::string>(value) == spec.choices.front()) continue;
    text += fmt::format(" {} = {},", spec.name, valueText(value));
  }
  text.pop_back();
  return text;
}

}  // namespace

std::string settingsText(const Scenario& scenario) {
  std::string text;
  for (const ControllerConfig& controller : scenario.controllers) text += controllerText(controller) + "; ";
  text += fmt::format("step {:g} ms", scenario.stepSeconds() * 1e3);
  std::vector<double> limits;
  for (const Joint& joint : scenario.robot.joints) limits.push_back(joint.effort_limit);
  if (std::any_of(limits.begin(), limits.end(), [](double limit) { return std::isfinite(limit); })) {
    text += fmt::format("; efforts limited to ({:g})", fmt::join(limits, ", "));
  }
  for (const PlaneSpec& wall : scenario.walls) {
    text += fmt::format("; wall of {:g} N/m", wall.stiffness_N_per_m);
    if (wall.damping_N_s_per_m > 0.0) text += fmt::format(" and {:g} N s/m", wall.damping_N_s_per_m);
  }
  if (const auto& noise = scenario.trajectory.noise) {
    const JointVector& sigma = noise->standard_deviation;
    text += fmt::format("; noise on q_d, of standard deviation ({:g}), new every {:g} s",
                        fmt::join(sigma.data(), sigma.data() + sigma.size(), ", "), noise->hold_s);
  }
  return text;
}

}  // namespace baton
