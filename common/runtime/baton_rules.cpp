#include "runtime/baton_rules.hpp"

#include <algorithm>

#include "control/law.hpp"
#include "runtime/service_options.hpp"

namespace baton {

ArbiterConfig arbiterConfig(const Scenario& scenario) {
  const std::vector<std::string> names = controllerNames(scenario);
  const auto index = [&](const std::string& name) {
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  ArbiterConfig config{.members = {},
                       .holder = index(scenario.active),
                       .fallback = {},
                       .margin_steps = scenario.baton.margin_steps,
                       .blend_steps = scenario.baton.blend_steps,
                       .max_effort_step = scenario.baton.max_effort_step,
                       .end_step = scenario.end_step};
  for (const ControllerConfig& controller : scenario.controllers) {
    config.members.push_back({controller.name, findLaw(controller.law).requires_contact});
  }
  for (const std::string& name : scenario.baton.fallback) config.fallback.push_back(index(name));
  return config;
}

ReasonText objectionTo(const msg::JointCommand& command, const Scenario& scenario, const char* ails,
                       JointVector& effort) {
  ReasonText objection{};
  if (command.effort().empty()) {
    write(objection, "its law has no effort to give%s%s", *ails != '\0' ? ": " : "", ails);
  } else if (const Reading reading = fromMessage(command, scenario.robot.size(), effort); !reading) {
    write(objection, "it sent a joint_command whose %s %s", reading.field, reading.wrong);
  } else if (const double largest = effort.cwiseAbs().maxCoeff(); largest > scenario.baton.max_command) {
    write(objection, "it commanded %.4g, above the scenario's max_command of %.4g", largest,
          scenario.baton.max_command);
  }
  return objection;
}

}  // namespace baton
