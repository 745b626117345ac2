#include "plot.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include "base/error.hpp"
#include "control/nearest_name.hpp"
#include "gnuplot.hpp"
#include "theory.hpp"
#include "theory_tools.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

constexpr Eigen::Index kMaxPoints = 1500;  // of a curve: more than a drawing has pixels

std::string named(const std::string& run, const std::string& what) { return run.empty() ? what : run + ", " + what; }

/// One panel a label; `add(panel, row, run)` draws the curves of each run into it.
template <class Add>
std::vector<Panel> panelsOf(const std::vector<LabelledRun>& runs, const std::vector<std::string>& labels,
                            const Add& add) {
  std::vector<Panel> panels;
  for (std::size_t row = 0; row < labels.size(); ++row) {
    Panel panel{.y_label = labels[row], .curves = {}};
    for (std::size_t run = 0; run < runs.size(); ++run) add(panel, static_cast<Eigen::Index>(row), run);
    panels.push_back(std::move(panel));
  }
  return panels;
}

using Rows = Eigen::MatrixXd Trace::*;

/// The rows of `actual`, with those of `desired` where there are any.
std::vector<Panel> signalPanels(const std::vector<LabelledRun>& runs, const std::vector<std::string>& labels,
                                Rows actual, Rows desired) {
  return panelsOf(runs, labels, [&](Panel& panel, Eigen::Index row, std::size_t run) {
    const Trace& trace = *runs[run].trace;
    const std::string& label = runs[run].label;
    panel.curves.push_back({label.empty() ? "actual" : label, &trace, (trace.*actual).row(row), run, false});
    if (desired == nullptr || !(trace.*desired).row(row).array().isFinite().any()) return;
    if (desired == &Trace::h_d && trace.h_d.isZero(0.0)) return;  // nobody's wish: most laws do not control force
    // The same reference is drawn once.
    const Eigen::MatrixXd& first = runs[0].trace->*desired;
    if (run > 0 && (trace.*desired).cols() == first.cols() && (trace.*desired).row(row) == first.row(row)) return;
    panel.curves.push_back(
        {run == 0 ? "desired" : named(label, "desired"), &trace, (trace.*desired).row(row), run, true});
  });
}

std::vector<Panel> errorPanels(const std::vector<LabelledRun>& runs, const std::vector<std::string>& labels,
                               Rows actual, Rows desired) {
  return panelsOf(runs, labels, [&](Panel& panel, Eigen::Index row, std::size_t run) {
    const Trace& trace = *runs[run].trace;
    panel.curves.push_back({runs[run].label.empty() ? "desired - actual" : runs[run].label, &trace,
                            (trace.*desired).row(row) - (trace.*actual).row(row), run, false});
  });
}

/// How far from q_d as it would be without noise. What q_d is only noise of, an arm should not follow.
std::vector<Panel> goalErrorPanels(const std::vector<LabelledRun>& runs, const std::vector<std::string>& labels) {
  std::vector<Eigen::MatrixXd> goals;
  goals.reserve(runs.size());
  for (const LabelledRun& run : runs) {
    const Trace& trace = *run.trace;
    const Trajectory trajectory = theory::quietTrajectory(trace.scenario);
    Reference wanted;
    Eigen::MatrixXd& goal = goals.emplace_back(trace.q.rows(), trace.steps());
    for (Eigen::Index k = 0; k < trace.steps(); ++k) {
      trajectory.evaluate(trace.time(k), wanted);
      goal.col(k) = wanted.q;
    }
  }
  return panelsOf(runs, labels, [&](Panel& panel, Eigen::Index row, std::size_t run) {
    const Trace& trace = *runs[run].trace;
    panel.curves.push_back({runs[run].label.empty() ? "goal - actual" : runs[run].label, &trace,
                            goals[run].row(row) - trace.q.row(row), run, false});
  });
}

/// Errors that differ by orders of magnitude can be told apart on a logarithmic axis only.
std::vector<Panel> sizesOf(std::vector<Panel> panels) {
  for (Panel& panel : panels) {
    panel.log_y = true;
    for (Curve& curve : panel.curves) curve.y = curve.y.cwiseAbs();
  }
  return panels;
}

/// Where force control wants the tip, x_F, which is nobody's message, and where it is.
std::vector<Panel> forceReferencePanels(const std::vector<LabelledRun>& runs) {
  std::vector<Eigen::MatrixXd> x_F;
  x_F.reserve(runs.size());
  for (const LabelledRun& run : runs) x_F.push_back(forceReference(*run.trace));
  return panelsOf(runs, {"x [m]", "y [m]", "z [m]"}, [&](Panel& panel, Eigen::Index row, std::size_t run) {
    const Trace& trace = *runs[run].trace;
    panel.curves.push_back({named(runs[run].label, "x_e"), &trace, trace.p_WE.row(row), run, false});
    panel.curves.push_back({named(runs[run].label, "x_F"), &trace, x_F[run].row(row), run, true});
  });
}

std::vector<std::string> jointLabels(const Trace& trace, const std::string& symbol, const std::string& turning,
                                     const std::string& sliding) {
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < trace.scenario.robot.joints.size(); ++i) {
    const bool turns = trace.scenario.robot.joints[i].kind == JointKind::kRevolute;
    const std::string subscript = fmt::format("_{{{}}}", i + 1);
    const std::size_t bar = symbol.rfind('|');  // of a size, |e_{1}|
    const std::string whole =
        bar == std::string::npos ? symbol + subscript : symbol.substr(0, bar) + subscript + symbol.substr(bar);
    labels.push_back(fmt::format("{} [{}]", whole, turns ? turning : sliding));
  }
  return labels;
}

std::vector<Panel> panels(const std::string& kind, const std::vector<LabelledRun>& runs) {
  const Trace& first = *runs.front().trace;
  if (kind == "joints") return signalPanels(runs, jointLabels(first, "q", "rad", "m"), &Trace::q, &Trace::q_d);
  if (kind == "joint_errors") return errorPanels(runs, jointLabels(first, "e", "rad", "m"), &Trace::q, &Trace::q_d);
  if (kind == "joint_error_sizes") {
    return sizesOf(errorPanels(runs, jointLabels(first, "|e|", "rad", "m"), &Trace::q, &Trace::q_d));
  }
  if (kind == "goal_errors") return goalErrorPanels(runs, jointLabels(first, "goal - q", "rad", "m"));
  if (kind == "efforts") return signalPanels(runs, jointLabels(first, "\u03c4", "N m", "N"), &Trace::tau, nullptr);
  if (kind == "tip") return signalPanels(runs, {"x [m]", "y [m]", "z [m]"}, &Trace::p_WE, &Trace::p_WE_d);
  if (kind == "tip_errors") return errorPanels(runs, {"e_x [m]", "e_y [m]", "e_z [m]"}, &Trace::p_WE, &Trace::p_WE_d);
  if (kind == "angles") {
    return signalPanels(runs, {"\u03c6 [rad]", "\u03d1 [rad]", "\u03c8 [rad]"}, &Trace::zyz, &Trace::zyz_d);
  }
  if (kind == "force_reference") return forceReferencePanels(runs);
  if (kind == "force") return signalPanels(runs, {"f_x [N]", "f_y [N]", "f_z [N]"}, &Trace::h_e, &Trace::h_d);
  throw UsageError(unknownName("plot", kind, plotKinds()));
}

/// Steps to draw: all of a short curve; of a long one the first, the last and, of each stretch, the lowest and the
/// highest, so that no peak is lost.
std::vector<Eigen::Index> drawnSteps(const Eigen::RowVectorXd& y) {
  std::vector<Eigen::Index> drawn;
  const Eigen::Index steps = y.size();
  const Eigen::Index stretches = std::min(steps, kMaxPoints / 2);
  drawn.reserve(static_cast<std::size_t>(2 * stretches + 2));
  drawn.push_back(0);
  for (Eigen::Index i = 0; i < stretches; ++i) {
    const Eigen::Index from = i * steps / stretches;
    const Eigen::Index to = (i + 1) * steps / stretches;
    Eigen::Index low = from;
    Eigen::Index high = from;
    for (Eigen::Index k = from; k < to; ++k) {
      if (std::isnan(y(low)) || y(k) < y(low)) low = k;
      if (std::isnan(y(high)) || y(k) > y(high)) high = k;
    }
    drawn.push_back(std::min(low, high));
    drawn.push_back(std::max(low, high));
  }
  drawn.push_back(steps - 1);
  drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
  return drawn;
}

/// When the tip first touches something [s]; nothing when it never does.
std::optional<double> firstContact(const Trace& trace) {
  for (Eigen::Index k = 0; k < trace.steps(); ++k) {
    if (trace.h_e.col(k).head<3>().squaredNorm() > 0.0) return trace.time(k);
  }
  return std::nullopt;
}

constexpr const char* kDesiredColour = "#555555";

/// Where the colours begin again, the curves are dashed: gnuplot's dash types from 3 on.
std::size_t dashesOf(const Curve& curve) {
  const std::size_t round = curve.colour / std::size(kCurveColours);
  return round == 0 ? 1 : 2 + round;
}

void writeMarks(std::ostream& script, const std::vector<LabelledRun>& runs) {
  int tag = 1;
  const auto mark = [&](double time_s, const std::string& text, const char* colour) {
    script << fmt::format("set arrow {} from {},graph 0 to {},graph 1 nohead lc rgb '{}' dt 3\n", tag, time_s, time_s,
                          colour);
    if (!text.empty()) {
      script << fmt::format(
          "set label {} {} at {},graph 0.04 rotate left offset -0.4,0 tc rgb '{}' font ',9' noenhanced\n", tag,
          quoted(text), time_s, colour);
    }
    ++tag;
  };
  constexpr std::size_t kMostNames = 20;  // more could not be read
  for (const LabelledRun& run : runs) {
    for (const msg::SwapOutcome& swap : run.trace->swaps) {
      mark(static_cast<double>(swap.at_step()) * run.trace->scenario.stepSeconds(),
           run.trace->swaps.size() > kMostNames ? "" : std::string("to ") + swap.incoming().c_str(), "#777777");
    }
  }
  std::multimap<double, std::string> touches;
  for (const LabelledRun& run : runs) {
    if (const auto touch = firstContact(*run.trace)) touches.emplace(*touch, run.label);
  }
  const double close = 0.03 * runs.front().trace->time(runs.front().trace->last());  // one text's height
  for (auto touch = touches.begin(); touch != touches.end();) {  // those that touch nearly together share a mark
    const double time_s = touch->first;
    std::string who;
    std::size_t count = 0;
    for (; touch != touches.end() && touch->first <= time_s + close; ++touch, ++count) {
      who += (who.empty() ? ": " : ", ") + touch->second;
    }
    mark(time_s, count == touches.size() ? "contact" : "contact" + who, "#b0306a");
  }
}

struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  [[nodiscard]] double size() const { return std::max(0.0, high - low); }
};

Span spanOf(const Panel& panel) {
  Span span;
  for (const Curve& curve : panel.curves) {
    for (const double y : curve.y) {
      if (!std::isfinite(y)) continue;
      span.low = std::min(span.low, y);
      span.high = std::max(span.high, y);
    }
  }
  return span;
}

/// A panel where nothing happens is drawn as flat as it is, at the scale of the others: left to itself, gnuplot would
/// blow rounding errors up to the size of the panel.
std::string yRange(const Panel& panel, double largest_span) {
  constexpr double kFlat = 1e-9;          // of what happens elsewhere
  constexpr double kSmallestSize = 1e-6;  // on a logarithmic axis, of the largest
  const Span span = spanOf(panel);
  if (panel.log_y && span.high > 0.0) {
    return fmt::format("set logscale y\nset format y '10^{{%T}}'\nset yrange [{}:{}]\n", span.high * kSmallestSize,
                       span.high * 2.0);
  }
  const double half = largest_span > 0.0 ? largest_span / 2.0 : 1.0;
  if (span.low > span.high) return fmt::format("set yrange [{}:{}]\n", -half, half);  // nothing to draw
  const bool is_flat = span.size() <= std::max(kFlat * largest_span, 1e-12 * std::abs(span.high));
  return is_flat ? fmt::format("set yrange [{}:{}]\n", span.low - half, span.high + half) : "set autoscale y\n";
}

std::string dataOf(const std::vector<Panel>& all) {
  std::ostringstream data;
  data.precision(9);
  for (std::size_t p = 0; p < all.size(); ++p) {
    for (std::size_t c = 0; c < all[p].curves.size(); ++c) {
      const Curve& curve = all[p].curves[c];
      data << fmt::format("$data_{}_{} << end\n", p, c);
      for (const Eigen::Index k : drawnSteps(curve.y)) {
        data << curve.trace->time(k) << ' ';
        if (std::isfinite(curve.y(k))) {
          data << curve.y(k) << '\n';
        } else {
          data << "nan\n";
        }
      }
      data << "end\n";
    }
  }
  return data.str();
}

std::string commandsFor(const std::string& title, const std::vector<Panel>& all, const std::vector<LabelledRun>& runs) {
  std::ostringstream commands;
  double largest_span = 0.0;
  for (const Panel& panel : all) largest_span = std::max(largest_span, spanOf(panel).size());
  commands << fmt::format("set multiplot layout {},1 title {} noenhanced\n", all.size(), quoted(title));
  commands << "set grid lc rgb '#dddddd'\nset key outside right top vertical maxrows 40 samplen 2\nset lmargin 14\n";
  // All panels have the same width, so that one instant is in one place, and room above and below the curves.
  std::size_t longest = 0;
  for (const Panel& panel : all) {
    for (const Curve& curve : panel.curves) longest = std::max(longest, curve.label.size());
  }
  commands << fmt::format("set rmargin {}\nset offsets 0, 0, graph 0.05, graph 0.05\n", longest + 6);
  writeMarks(commands, runs);
  for (std::size_t p = 0; p < all.size(); ++p) {
    commands << fmt::format("set ylabel {}\n", quoted(all[p].y_label)) << yRange(all[p], largest_span);
    commands << (p + 1 == all.size() ? "set xlabel 'time [s]'\n" : "set xlabel ''\n");
    commands << "plot ";
    for (std::size_t c = 0; c < all[p].curves.size(); ++c) {
      const Curve& curve = all[p].curves[c];
      const char* colour = curve.is_desired ? kDesiredColour : kCurveColours[curve.colour % std::size(kCurveColours)];
      commands << fmt::format("{}$data_{}_{} using 1:2 with lines lc rgb '{}' lw {} dt {} title {} noenhanced",
                              c == 0 ? "" : ", ", p, c, colour, curve.is_desired ? "1.2" : "1.6",
                              curve.is_desired ? 2 : dashesOf(curve), quoted(curve.label));
    }
    commands << '\n';
  }
  commands << "unset multiplot\n";
  return commands.str();
}

}  // namespace

const std::vector<std::string>& plotKinds() {
  static const std::vector<std::string> kinds{
      "joints",     "joint_errors", "joint_error_sizes", "goal_errors", "tip",
      "tip_errors", "angles",       "efforts",           "force",       "force_reference"};
  return kinds;
}

void draw(const fs::path& stem, const std::string& title, const std::string& kind, const std::vector<LabelledRun>& runs,
          double until_s) {
  std::vector<Panel> all = panels(kind, runs);
  if (until_s > 0.0) {
    for (Panel& panel : all) {
      for (Curve& curve : panel.curves) {
        const auto steps = static_cast<Eigen::Index>(std::ceil(until_s / curve.trace->scenario.stepSeconds())) + 1;
        curve.y.conservativeResize(std::min(steps, curve.y.size()));
      }
    }
  }
  draw(stem, title, all, runs);
}

void draw(const fs::path& stem, const std::string& title, const std::vector<Panel>& panels,
          const std::vector<LabelledRun>& runs) {
  std::size_t most = 0;  // curves of a panel, each with a line in its legend
  for (const Panel& panel : panels) most = std::max(most, panel.curves.size());
  drawScript(stem, {860, 90 + std::max<std::size_t>(190, 60 + 18 * most) * panels.size()}, dataOf(panels),
             commandsFor(title, panels, runs));
}

}  // namespace baton
