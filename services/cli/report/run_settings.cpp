#include "run_settings.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "control/law.hpp"
#include "messages/parameters.hpp"
#include "theory_tools.hpp"
#include "trajectory/trajectory.hpp"

namespace baton {
namespace {

/// Gains always, what only switches something when it is not at its default.
std::string controllerText(const ControllerConfig& controller) {
  std::string text = controller.law + ":";
  for (const ParameterSpec& spec : findLaw(controller.law).parameters) {
    const ParameterValue& value = controller.parameters.at(spec.name);
    const bool is_switch = spec.size == ParameterSize::kChoice;
    if (is_switch && std::get<std::string>(value) == spec.choices.front()) continue;
    text += fmt::format(" {} = {},", spec.name, toText(value));
  }
  text.pop_back();
  return text;
}

template <class Vector>
std::string row(const Vector& values) {
  return fmt::format("({:.6g})", fmt::join(values.data(), values.data() + values.size(), ", "));
}

std::string motionText(const Scenario& scenario) {
  const Trajectory trajectory = theory::quietTrajectory(scenario);
  Reference goal;
  const double end_s = static_cast<double>(scenario.end_step) * scenario.stepSeconds();
  trajectory.evaluate(end_s, goal);
  std::string text = "q from " + row(scenario.start_q);
  if (std::isfinite(trajectory.endTime())) {  // else it swings on, and has no goal
    if (goal.q.size() > 0) text += ", q_d in the end " + row(goal.q);
    if (goal.has_task) text += ", x_d " + row(goal.X_WE.p);
  }
  if (goal.has_task && !goal.h_d.isZero(0.0)) text += ", f_d " + row(Vector3(goal.h_d.head<3>()));
  return text + fmt::format(", {:g} s", end_s);
}

}  // namespace

std::string settingsText(const Scenario& scenario) {
  std::string text = motionText(scenario) + "; ";
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
