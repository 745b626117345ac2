#include "shadow.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/plural.hpp"
#include "runtime/json.hpp"
#include "theory_tools.hpp"

namespace baton {
namespace {

ShadowJoint jointOf(const RecordedEfforts& run, int who, int i) {
  const Trace& trace = run.trace;
  ShadowJoint joint{.name = fmt::format("tau{}", i + 1),
                    .unit = theory::effortUnit(trace.scenario.robot, i),
                    .rms = kNan,
                    .largest = kNan,
                    .jump = kNan,
                    .last_jump = kNan};
  const auto effort = run.effort[static_cast<std::size_t>(who)].row(i);
  double sum = 0.0;
  std::uint64_t count = 0;
  const auto raise = [&](double& largest, std::uint64_t& at_step, double value, Eigen::Index k) {
    if (std::isnan(value) || std::abs(value) <= largest) return;
    largest = std::abs(value);
    at_step = trace.first_step + static_cast<std::uint64_t>(k);
  };
  for (Eigen::Index k = 0; k < trace.last(); ++k) {
    if (run.holder[static_cast<std::size_t>(k)] == who || std::isnan(effort(k))) continue;
    const double difference = effort(k) - trace.tau(i, k + 1);
    raise(joint.largest, joint.largest_at_step, difference, k);
    if (!std::isnan(difference)) {
      sum += difference * difference;
      ++count;
    }
    if (k == 0) continue;  // nothing has been felt yet
    const double jump = effort(k) - trace.tau(i, k);
    raise(joint.jump, joint.jump_at_step, jump, k);
    if (!std::isnan(jump)) joint.last_jump = jump;
  }
  if (count > 0) joint.rms = std::sqrt(sum / static_cast<double>(count));
  return joint;
}

std::string numberText(double value) { return std::isfinite(value) ? fmt::format("{:.4e}", value) : "-"; }

std::string instant(double value, std::uint64_t step, double step_s) {
  return std::isfinite(value) ? fmt::format("{} ({:.4f} s)", step, static_cast<double>(step) * step_s) : "-";
}

}  // namespace

Shadow shadowOf(const RecordedEfforts& run) {
  const Trace& trace = run.trace;
  Shadow shadow{.steps = static_cast<std::uint64_t>(trace.last()),
                .duration_s = static_cast<double>(trace.last()) * trace.scenario.stepSeconds(),
                .step_s = trace.scenario.stepSeconds(),
                .cut = run.cut,
                .is_cold = !trace.scenario.hot_standby,
                .controllers = {}};
  for (std::size_t c = 0; c < trace.scenario.controllers.size(); ++c) {
    const ControllerConfig& config = trace.scenario.controllers[c];
    ShadowController controller{.name = config.name, .law = config.law, .joints = {}};
    for (Eigen::Index k = 0; k < trace.last(); ++k) {
      if (run.holder[static_cast<std::size_t>(k)] == static_cast<int>(c)) controller.held += 1.0;
      if (run.effort[c].col(k).hasNaN()) controller.silent += 1.0;
    }
    const double all = std::max(1.0, static_cast<double>(trace.last()));
    controller.held /= all;
    controller.silent /= all;
    for (int i = 0; i < trace.scenario.robot.size(); ++i) {
      controller.joints.push_back(jointOf(run, static_cast<int>(c), i));
    }
    shadow.controllers.push_back(std::move(controller));
  }
  return shadow;
}

nlohmann::ordered_json toJson(const Shadow& shadow) {
  nlohmann::ordered_json json{{"steps", shadow.steps},
                              {"duration_s", shadow.duration_s},
                              {"cut", shadow.cut},
                              {"standby", shadow.is_cold ? "cold" : "hot"},
                              {"controllers", nlohmann::ordered_json::array()}};
  for (const ShadowController& controller : shadow.controllers) {
    nlohmann::ordered_json joints = nlohmann::ordered_json::array();
    for (const ShadowJoint& joint : controller.joints) {
      joints.push_back({{"name", joint.name},
                        {"unit", joint.unit},
                        {"rms", orNull(joint.rms)},
                        {"largest", orNull(joint.largest)},
                        {"largest_at_step", joint.largest_at_step},
                        {"jump", orNull(joint.jump)},
                        {"jump_at_step", joint.jump_at_step},
                        {"last_jump", orNull(joint.last_jump)}});
    }
    json["controllers"].push_back({{"name", controller.name},
                                   {"law", controller.law},
                                   {"held", controller.held},
                                   {"silent", controller.silent},
                                   {"joints", joints}});
  }
  return json;
}

std::string toText(const Shadow& shadow) {
  std::string text = fmt::format("{}, {:.4f} s{}\n", counted(shadow.steps, "step"), shadow.duration_s,
                                 shadow.cut.empty() ? "" : ", cut off: " + shadow.cut);
  if (shadow.is_cold) {
    text += "standby: cold, so that who stood by did not compute: of a controller only what it commanded is recorded\n";
  }
  text += fmt::format("{:<40}{:>12}{:>12}  {:<22}{:>12}  {:<22}{:>12}\n", "what it would have done differently", "rms",
                      "largest", "at step", "jump", "at step", "jump at end");
  for (const ShadowController& controller : shadow.controllers) {
    text += fmt::format("{} ({}): held {:.1f} %, without effort {:.1f} %\n", controller.name, controller.law,
                        100.0 * controller.held, 100.0 * controller.silent);
    for (const ShadowJoint& joint : controller.joints) {
      text += fmt::format("  {:<38}{:>12}{:>12}  {:<22}{:>12}  {:<22}{:>12}\n", joint.name + " [" + joint.unit + "]",
                          numberText(joint.rms), numberText(joint.largest),
                          instant(joint.largest, joint.largest_at_step, shadow.step_s), numberText(joint.jump),
                          instant(joint.jump, joint.jump_at_step, shadow.step_s), numberText(joint.last_jump));
    }
  }
  return text;
}

std::vector<Panel> shadowPanels(const RecordedEfforts& run) {
  const Trace& trace = run.trace;
  std::vector<Panel> panels;
  for (int i = 0; i < trace.scenario.robot.size(); ++i) {
    Panel panel{.y_label = fmt::format("\u03c4_{{{}}} [{}]", i + 1, theory::effortUnit(trace.scenario.robot, i)),
                .curves = {}};
    for (std::size_t c = 0; c < run.effort.size(); ++c) {
      const Eigen::RowVectorXd effort = run.effort[c].row(i);
      if (!effort.array().isFinite().any()) continue;  // the table says that it has none
      panel.curves.push_back({trace.scenario.controllers[c].name, &trace, effort, c, false});
    }
    Eigen::RowVectorXd felt = Eigen::RowVectorXd::Constant(trace.steps(), kNan);
    felt.head(trace.last()) = trace.tau.row(i).tail(trace.last());
    panel.curves.push_back({"applied", &trace, std::move(felt), 0, true});
    panels.push_back(std::move(panel));
  }
  return panels;
}

}  // namespace baton
