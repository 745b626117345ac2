#include "metrics.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/plural.hpp"
#include "runtime/json.hpp"
#include "theory_tools.hpp"

namespace baton {
namespace {

constexpr double kSettled = 0.02;  // part of the stroke

/// The integral over the run by trapezoids, of what f gives at each step.
template <class F>
double integral(Eigen::Index steps, double dt_s, const F& f) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k + 1 < steps; ++k) sum += 0.5 * (f(k) + f(k + 1));
  return sum * dt_s;
}

using RowRef = Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

/// @param desired, actual  one signal each.
ErrorMetrics errorMetrics(std::string name, std::string unit, const RowRef& desired, const RowRef& actual,
                          double dt_s) {
  ErrorMetrics m{.name = std::move(name), .unit = std::move(unit)};
  const Eigen::Index steps = actual.size();
  const auto error = [&](Eigen::Index k) { return desired(k) - actual(k); };
  const double duration_s = static_cast<double>(steps - 1) * dt_s;
  m.final = error(steps - 1);
  for (Eigen::Index k = 0; k < steps; ++k) m.peak = std::max(m.peak, std::abs(error(k)));
  m.iae = integral(steps, dt_s, [&](Eigen::Index k) { return std::abs(error(k)); });
  m.rms = duration_s > 0.0
              ? std::sqrt(integral(steps, dt_s, [&](Eigen::Index k) { return error(k) * error(k); }) / duration_s)
              : std::abs(m.final);

  const double goal = desired(steps - 1);
  const double stroke = goal - actual(0);
  m.overshoot = m.settling_s = kNan;
  const bool is_set_point = (desired.array() == goal).all();
  if (!is_set_point || !(std::abs(stroke) > 1e-9)) return m;
  m.overshoot = 0.0;
  Eigen::Index outside = -1;  // the last step that is not settled
  for (Eigen::Index k = 0; k < steps; ++k) {
    m.overshoot = std::max(m.overshoot, (actual(k) - goal) / stroke);
    if (!(std::abs(actual(k) - goal) <= kSettled * std::abs(stroke))) outside = k;
  }
  if (outside + 1 < steps) m.settling_s = static_cast<double>(outside + 1) * dt_s;
  return m;
}

nlohmann::ordered_json toJson(const ErrorMetrics& m) {
  return {{"name", m.name},
          {"unit", m.unit},
          {"final", orNull(m.final)},
          {"rms", orNull(m.rms)},
          {"peak", orNull(m.peak)},
          {"iae", orNull(m.iae)},
          {"overshoot", orNull(m.overshoot)},
          {"settling_s", orNull(m.settling_s)}};
}

std::string numberText(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

void addRows(const std::vector<ErrorMetrics>& rows, const char* title, std::string& text) {
  if (rows.empty()) return;
  text += fmt::format("{:<14}{:>13}{:>13}{:>13}{:>13}{:>11}{:>13}\n", title, "final", "rms", "peak", "iae [.. s]",
                      "overshoot", "settled [s]");
  for (const ErrorMetrics& m : rows) {
    text += fmt::format("  {:<12}{:>13}{:>13}{:>13}{:>13}{:>11}{:>13}\n", m.name + " [" + m.unit + "]",
                        numberText(m.final, "{:.4e}"), numberText(m.rms, "{:.4e}"), numberText(m.peak, "{:.4e}"),
                        numberText(m.iae, "{:.4e}"),
                        std::isfinite(m.overshoot) ? fmt::format("{:.1f} %", 100.0 * m.overshoot) : "-",
                        numberText(m.settling_s, "{:.4f}"));
  }
}

}  // namespace

Metrics metricsOf(const Trace& trace) {
  const RobotModel& robot = trace.scenario.robot;
  const double dt_s = trace.scenario.stepSeconds();
  Metrics m;
  m.steps = static_cast<std::uint64_t>(trace.last());
  m.duration_s = trace.time(trace.last()) - trace.time(0);
  m.missed_steps = trace.missed_steps;
  const auto isUnrecorded = [](const Eigen::MatrixXd& signal) { return signal.row(0).array().isNaN().eval(); };
  auto unrecorded = isUnrecorded(trace.q);
  const bool has_joints = !isUnrecorded(trace.q_d).all(), has_task = !isUnrecorded(trace.p_WE_d).all();
  if (has_joints) unrecorded = unrecorded || isUnrecorded(trace.q_d);
  if (has_task) unrecorded = unrecorded || isUnrecorded(trace.p_WE_d);
  m.unrecorded_steps = static_cast<std::uint64_t>(unrecorded.count());
  for (int i = 0; i < robot.size(); ++i) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(i)];
    if (has_joints) {
      m.joints.push_back(
          errorMetrics(theory::jointName(i), theory::jointUnit(robot, i), trace.q_d.row(i), trace.q.row(i), dt_s));
    }
    EffortMetrics effort{.name = "tau" + std::to_string(i + 1), .unit = theory::effortUnit(robot, i)};
    for (Eigen::Index k = 1; k < trace.steps(); ++k) {  // at step 0 nothing has been applied yet
      effort.peak = std::max(effort.peak, std::abs(trace.tau(i, k)));
      if (std::abs(trace.tau(i, k)) >= joint.effort_limit) effort.saturated_s += dt_s;
    }
    m.efforts.push_back(effort);
  }
  if (has_task) {
    for (int i = 0; i < 3; ++i) {
      m.task.push_back(errorMetrics(std::string(1, "xyz"[i]), "m", trace.p_WE_d.row(i), trace.p_WE.row(i), dt_s));
    }
    // An angle is never negative: as an error signal it has size and no stroke.
    const Eigen::RowVectorXd angle = trace.orientation.colwise().norm();
    const Eigen::RowVectorXd none = Eigen::RowVectorXd::Zero(angle.size());
    ErrorMetrics turned = errorMetrics("angle", "rad", angle, none, dt_s);
    turned.overshoot = turned.settling_s = kNan;
    m.task.push_back(std::move(turned));
  }
  m.final_force_N = trace.h_e.col(trace.last()).head<3>();
  if (trace.first_step > 0) {  // the way began before the recording did
    for (std::vector<ErrorMetrics>* signals : {&m.joints, &m.task}) {
      for (ErrorMetrics& one : *signals) one.overshoot = one.settling_s = kNan;
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (Eigen::Index k = 0; k < trace.steps(); ++k) {
      const double force = trace.h_e(i, k);
      if (std::isnan(m.peak_force_N[i]) || std::abs(force) > std::abs(m.peak_force_N[i])) m.peak_force_N[i] = force;
    }
  }
  return m;
}

nlohmann::ordered_json toJson(const Metrics& m) {
  nlohmann::ordered_json json{{"steps", m.steps},
                              {"unrecorded_steps", m.unrecorded_steps},
                              {"duration_s", m.duration_s},
                              {"missed_steps", m.missed_steps}};
  json["joints"] = nlohmann::ordered_json::array();
  for (const ErrorMetrics& joint : m.joints) json["joints"].push_back(toJson(joint));
  json["task"] = nlohmann::ordered_json::array();
  for (const ErrorMetrics& axis : m.task) json["task"].push_back(toJson(axis));
  json["efforts"] = nlohmann::ordered_json::array();
  for (const EffortMetrics& effort : m.efforts) {
    json["efforts"].push_back(
        {{"name", effort.name}, {"unit", effort.unit}, {"peak", effort.peak}, {"saturated_s", effort.saturated_s}});
  }
  const auto threeOf = [](const Vector3& v) {
    return nlohmann::ordered_json{orNull(v[0]), orNull(v[1]), orNull(v[2])};
  };
  json["force_N"] = {{"final", threeOf(m.final_force_N)}, {"peak", threeOf(m.peak_force_N)}};
  return json;
}

std::string toText(const Metrics& m) {
  std::string text = fmt::format("{}, {:.4f} s, {} missed\n", counted(m.steps, "step"), m.duration_s, m.missed_steps);
  if (m.unrecorded_steps > 0) {
    text += fmt::format("{} {} not recorded: what is unknown without is a dash, peaks are of the others\n",
                        counted(m.unrecorded_steps, "step"), m.unrecorded_steps == 1 ? "was" : "were");
  }
  addRows(m.joints, "joints", text);
  addRows(m.task, "tip", text);
  text += fmt::format("{:<14}{:>13}{:>15}\n", "efforts", "peak", "saturated [s]");
  for (const EffortMetrics& effort : m.efforts) {
    text += fmt::format("  {:<12}{:>13.4e}{:>15.4f}\n", effort.name + " [" + effort.unit + "]", effort.peak,
                        effort.saturated_s);
  }
  const auto three = [](const Vector3& v) {
    return numberText(v[0], "{:.6f}") + ' ' + numberText(v[1], "{:.6f}") + ' ' + numberText(v[2], "{:.6f}");
  };
  text += fmt::format("force [N]     final {}   peak {}\n", three(m.final_force_N), three(m.peak_force_N));
  return text;
}

}  // namespace baton
