#include "coupling_charts.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "runtime/monolithic_run.hpp"
#include "sprung_mass.hpp"
#include "theory_tools.hpp"

namespace baton::study {
namespace {

using theory::SprungMass;
using Style = ChartSeries::Style;
constexpr double kPi = 3.14159265358979323846;

/// `count` values from `from` to `to`, each the same multiple of the one before.
std::vector<double> geometric(double from, double to, int count) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) values.push_back(from * std::pow(to / from, static_cast<double>(i) / (count - 1)));
  return values;
}

// --- energy

std::vector<Eigen::Vector2d> energyOf(const Trace& trace, const SprungMass& mass) {
  constexpr Eigen::Index kPoints = 60;
  const JointVector along = theory::alongNormal(trace.scenario);
  const Eigen::Index stride = std::max<Eigen::Index>(1, trace.last() / kPoints);
  std::vector<Eigen::Vector2d> points;
  double start = 0.0;
  for (Eigen::Index k = 0; k < trace.steps(); k += stride) {
    const double x = theory::depthOf(trace.scenario, trace.p_WE.col(k)), v = along.dot(trace.qd.col(k));
    const double energy = 0.5 * (mass.m * v * v + mass.K * x * x);
    if (k == 0) start = energy;
    points.emplace_back(trace.time(k), energy / start);
  }
  return points;
}

// --- stability

struct GridPoint {
  double stiffness = 0.0;
  std::int64_t step_ns = 0;
  [[nodiscard]] double seconds() const { return static_cast<double>(step_ns) * 1e-9; }
};

Scenario variant(const Scenario& base, Coupling coupling, const GridPoint& point) {
  Scenario scenario = base;
  scenario.coupling = coupling;
  scenario.walls.front().stiffness_N_per_m = point.stiffness;
  scenario.step_ns = point.step_ns;
  scenario.end_step = 0;                                                 // as long as it takes
  scenario.baton.max_command = std::numeric_limits<double>::infinity();  // and as far as it goes
  return scenario;
}

/// Whether the motion dies out, as a run shows it: peaks of its energy over windows of a swing or more are compared,
/// after the modes that die out fast have done so.
bool diesOut(const Scenario& scenario) {
  const SprungMass mass = theory::sprungMassOf(scenario);
  const Vector3 normal = scenario.walls.front().normal.normalized();
  MonolithicRun run(scenario);
  const auto energy = [&] {
    const double x = theory::depthOf(scenario, run.state().X_WE.p), v = normal.dot(run.state().V_WE.head<3>());
    return 0.5 * (mass.m * v * v + mass.K * x * x);
  };
  const double swing = 2.0 * kPi * std::sqrt(mass.m / mass.K) / scenario.stepSeconds();
  const auto window = static_cast<int>(std::clamp(swing, 20.0, 20'000.0));
  const auto goesOn = [&] { return run.step() && run.failovers().empty(); };
  const auto peak = [&] {
    double highest = 0.0;
    for (int k = 0; k < window && goesOn(); ++k) highest = std::max(highest, energy());
    return highest;
  };
  const double start = energy();
  constexpr std::uint64_t kSettle = 200, kPatience = 30'000;  // steps
  constexpr double kDecided = 4.0;                            // twice or half the amplitude
  constexpr double kGone = 1e-20, kAway = 1e10;
  double reference = 0.0;
  while (run.whatWentWrong().empty()) {
    const double now = peak();
    if (now > kAway * start) return false;
    if (now < kGone * start) return true;
    if (run.steps() < kSettle) continue;
    if (reference == 0.0) {
      reference = now;
    } else if (now > kDecided * reference || now < reference / kDecided || run.steps() > kPatience) {
      return now < reference;
    }
  }
  return false;
}

/// The longest step at which a run still dies out [s], found between one that does and one that does not.
double measuredStableStep(const Scenario& base, Coupling coupling, double stiffness, double low_s, double high_s) {
  constexpr double kClose = 1.001;
  while (high_s / low_s > kClose) {
    const double middle_s = std::sqrt(low_s * high_s);
    (diesOut(variant(base, coupling, {stiffness, std::llround(middle_s * 1e9)})) ? low_s : high_s) = middle_s;
  }
  return std::sqrt(low_s * high_s);
}

// --- error

/// Counts of steps that divide the run into whole nanoseconds. All are 2 modulo 4, so that what happens after a quarter
/// of the run happens in the middle of a step whatever its length.
std::vector<std::uint64_t> stepCounts(std::uint64_t duration_ns, std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint64_t> counts;
  for (std::uint64_t n = from; n <= to; ++n) {
    if (n % 4 == 2 && duration_ns % n == 0) counts.push_back(n);
  }
  return counts;
}

Vector3 tipAtTheEnd(const Scenario& base, Coupling coupling, std::uint64_t steps) {
  Scenario scenario = base;
  scenario.coupling = coupling;
  scenario.step_ns = static_cast<std::int64_t>(base.end_step * static_cast<std::uint64_t>(base.step_ns) / steps);
  scenario.end_step = steps;
  MonolithicRun run(scenario);
  while (run.step()) {
  }
  if (const std::string wrong = run.whatWentWrong(); !wrong.empty()) {
    throw Error(ExitCode::kFailed, scenario.name + " in one process: " + wrong);
  }
  return run.state().X_WE.p;
}

/// Slope of log y over log x, by least squares.
double slopeOf(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) mean += Eigen::Vector2d(point.array().log()) / double(points.size());
  double xy = 0.0, xx = 0.0;
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d d = Eigen::Vector2d(point.array().log()) - mean;
    xy += d.x() * d.y();
    xx += d.x() * d.x();
  }
  return xy / xx;
}

}  // namespace

ChartResult couplingEnergy(const Inputs& in) {
  ChartPanel panel{.title = "energy of the mass and the spring, from the recordings",
                   .x_label = "time [s]",
                   .y_label = "energy / energy at the start",
                   .log_y = true,
                   .series = {}};
  for (std::size_t i = 0; i < in.runs.size(); ++i) {
    const Trace& trace = in.runs[i];
    const SprungMass mass = theory::sprungMassOf(trace.scenario);
    panel.series.push_back({.label = toString(trace.scenario.coupling),
                            .style = Style::kDots,
                            .colour = i,
                            .points = energyOf(trace, mass)});
    const double d = theory::couplingDamping(mass, trace.scenario.coupling, trace.scenario.stepSeconds());
    const double end_s = trace.time(trace.last());
    panel.series.push_back({.label = fmt::format("exp(-d t/m), d = {:.2g} N s/m", d),
                            .style = Style::kLine,
                            .colour = i,
                            .points = {{0.0, 1.0}, {end_s, std::exp(-d * end_s / mass.m)}}});
  }
  return {.chart = {{panel}}, .checks = {}};
}

ChartResult couplingStability(const Inputs& in) {
  const Scenario& base = in.base.scenario;
  const SprungMass mass = theory::sprungMassOf(base);
  const std::vector<double> stiffnesses = geometric(mass.K / 100.0, mass.K * 10.0, 14);
  const std::vector<double> steps_s = geometric(base.stepSeconds() / 60.0, base.stepSeconds() * 6.0, 16);
  const auto at = [&](double K) { return SprungMass{.m = mass.m, .K = K, .D = mass.D}; };
  ChartResult result;
  double done = 0.0;
  for (const Coupling coupling : kCouplings) {
    ChartSeries stable{.label = "dies out", .style = Style::kDots, .colour = 0, .points = {}};
    ChartSeries unstable{.label = "grows", .style = Style::kCrosses, .colour = 1, .points = {}};
    ChartSeries limit{.label = "limit by theory", .style = Style::kLine, .colour = 2, .points = {}};
    ChartSeries swing{
        .label = "half a swing a step; not tried above", .style = Style::kDashes, .colour = 3, .points = {}};
    int points = 0, agreeing = 0;
    for (const double K : stiffnesses) {
      for (const double step_s : steps_s) {
        const GridPoint point{K, std::llround(step_s * 1e9)};
        in.progress(done++ / static_cast<double>(std::size(kCouplings) * stiffnesses.size() * steps_s.size()));
        if (point.seconds() * std::sqrt(K / mass.m) > kPi) continue;
        const bool dies_out = diesOut(variant(base, coupling, point));
        const Matrix3 map = theory::stepMap(at(K), coupling, point.seconds(), base.substeps);
        ++points;
        agreeing += dies_out == (theory::spectralRadius(map) < 1.0) ? 1 : 0;
        (dies_out ? stable : unstable).points.emplace_back(K, point.seconds());
      }
    }
    for (const double K : geometric(stiffnesses.front(), stiffnesses.back(), 80)) {
      limit.points.emplace_back(K, theory::stableStep(at(K), coupling));
      const double half_s = kPi * std::sqrt(mass.m / K);
      if (half_s <= steps_s.back()) swing.points.emplace_back(K, half_s);
    }
    const std::string name = toString(coupling);
    result.chart.panels.push_back({.title = name,
                                   .x_label = "stiffness of the wall [N/m]",
                                   .y_label = "step [s]",
                                   .log_x = true,
                                   .log_y = true,
                                   .series = {stable, unstable, limit, swing}});
    result.checks.push_back(theory::within(name + ": points of the map where the run does what the eigenvalues say", "",
                                           points, agreeing, 0.0));
    const double measured =
        measuredStableStep(base, coupling, mass.K, steps_s.front(), kPi * std::sqrt(mass.m / mass.K));
    result.checks.push_back(theory::relative(name + ": longest stable step at the run's stiffness", "s",
                                             theory::stableStep(mass, coupling), measured, 0.01));
  }
  return result;
}

ChartResult couplingError(const Inputs& in) {
  const Scenario& base = in.base.scenario;
  const std::uint64_t duration_ns = base.end_step * static_cast<std::uint64_t>(base.step_ns);
  const std::vector<std::uint64_t> counts = stepCounts(duration_ns, base.end_step / 3, base.end_step * 3);
  const std::vector<std::uint64_t> finer = stepCounts(duration_ns, 16 * counts.back(), 32 * counts.back());
  if (counts.size() < 4 || finer.empty()) {
    throw UsageError("run " + base.name + ": expected a duration with many divisors for this study, found " +
                     std::to_string(duration_ns) + " ns");
  }
  const Vector3 reference = tipAtTheEnd(base, Coupling::kDerivatives, finer.front());
  const bool touches =
      std::any_of(base.walls.begin(), base.walls.end(), [](const auto& wall) { return wall.unilateral; });

  ChartPanel panel{.title = base.description,
                   .x_label = "step [s]",
                   .y_label = "distance from the fine run [m]",
                   .log_x = true,
                   .log_y = true,
                   .series = {}};
  ChartResult result;
  double done = 0.0;
  std::vector<double> at_finest;
  for (const Coupling coupling : kCouplings) {
    const std::size_t colour = at_finest.size();
    const std::string name = toString(coupling);
    ChartSeries errors{.label = name, .style = Style::kCircles, .colour = colour, .points = {}};
    for (const std::uint64_t steps : counts) {
      in.progress(done++ / static_cast<double>(std::size(kCouplings) * counts.size()));
      errors.points.emplace_back(static_cast<double>(duration_ns) * 1e-9 / static_cast<double>(steps),
                                 (tipAtTheEnd(base, coupling, steps) - reference).norm());
    }
    const int order = coupling != Coupling::kDerivatives ? 1 : touches ? 2 : 4;
    const Eigen::Vector2d coarsest = errors.points.front(), finest = errors.points.back();
    ChartSeries slope{
        .label = name + ", order " + std::to_string(order), .style = Style::kLine, .colour = colour, .points = {}};
    slope.points = {finest, {coarsest.x(), finest.y() * std::pow(coarsest.x() / finest.x(), order)}};
    at_finest.push_back(finest.y());
    result.checks.push_back(
        theory::within(name + ": order of the error in the step", "", order, slopeOf(errors.points), 0.15));
    panel.series.push_back(std::move(slope));
    panel.series.push_back(std::move(errors));
  }
  result.checks.push_back(theory::relative("error of late by error of held, at the finest step", "", 3.0,
                                           at_finest.at(2) / at_finest.at(1), 0.02));
  result.chart.panels.push_back(std::move(panel));
  return result;
}

}  // namespace baton::study
