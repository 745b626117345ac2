#include "pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "control/law.hpp"

namespace baton {
namespace {

constexpr double kAtRest = 0.005;  // m/s: a tip that is slower stands, as far as a handover can tell

using Pair = std::pair<std::size_t, std::size_t>;

/// Column `k` of a matrix; NaN before its first and after its last.
Eigen::VectorXd columnOf(const Eigen::MatrixXd& all, Eigen::Index k) {
  if (k < 0 || k >= all.cols()) return Eigen::VectorXd::Constant(all.rows(), kNan);
  return all.col(k);
}

constexpr auto kLargerOrNan = [](double a, double b) { return std::isnan(a) || a > b ? a : b; };

PairHandover handoverOf(const RecordedEfforts& run, std::size_t from, std::size_t to, std::uint64_t at_step) {
  const Trace& trace = run.trace;
  const auto K = static_cast<Eigen::Index>(at_step - trace.first_step);
  const Eigen::MatrixXd &outgoing = run.effort[from], &incoming = run.effort[to];
  const Eigen::VectorXd before = columnOf(trace.tau, K), after = columnOf(trace.tau, K + 1);  // tau(K-1), tau(K)
  const Eigen::VectorXd own_outgoing = (columnOf(outgoing, K) - columnOf(outgoing, K - 1)).cwiseAbs();
  const Eigen::VectorXd own_incoming = (columnOf(incoming, K + 1) - columnOf(incoming, K)).cwiseAbs();
  PairHandover handover{.from = from,
                        .to = to,
                        .at_step = at_step,
                        .change = (after - before).cwiseAbs(),
                        .own = own_outgoing.binaryExpr(own_incoming, kLargerOrNan),
                        .without_blend = (columnOf(incoming, K) - before).cwiseAbs()};
  const Eigen::VectorXd way = columnOf(trace.p_WE, K + 1) - columnOf(trace.p_WE, K);
  handover.tip_speed = way.norm() / trace.scenario.stepSeconds();
  handover.touches = !columnOf(trace.h_e, K).isZero(0.0);
  const auto report = std::find_if(run.reports.begin(), run.reports.end(),
                                   [&](const msg::SwapReport& one) { return one.at_step() == at_step; });
  if (report == run.reports.end()) return handover;
  handover.has_report = true;
  handover.cut_short = report->cut_short();
  handover.rate_limit_hits = report->rate_limit_hits();
  handover.blend_energy = report->blend_energy();
  handover.force_deviation = report->peak_force_deviation();
  const JointVector& limit = trace.scenario.baton.max_effort_rate;
  for (std::size_t i = 0; i < report->max_effort_rate().size() && static_cast<int>(i) < limit.size(); ++i) {
    handover.rate_share =
        std::max(handover.rate_share, report->max_effort_rate()[i] / limit(static_cast<Eigen::Index>(i)));
  }
  return handover;
}

Check count(std::string what, double predicted, double measured) {
  return {.what = std::move(what), .unit = "", .predicted = predicted, .measured = measured, .tolerance = 0.0};
}

/// Whether the scenario wants the arm to stand at all handovers.
bool isReferenceAtRest(const PairTable& table) {
  const Trace& trace = table.run->trace;
  return std::all_of(table.handovers.begin(), table.handovers.end(), [&](const PairHandover& one) {
    return columnOf(trace.qd_d, static_cast<Eigen::Index>(one.at_step - trace.first_step)).isZero(0.0);
  });
}

}  // namespace

double PairHandover::ratio() const {
  const Eigen::VectorXd ratios = change.array() / (own.array() + kBumpTolerance);
  return ratios.maxCoeff<Eigen::PropagateNaN>();
}

double PairHandover::excess() const {
  const Eigen::VectorXd excess = change - own;
  return std::max(excess.maxCoeff<Eigen::PropagateNaN>(), 0.0);  // in this order a NaN stays one
}

PairTable pairsOf(const RecordedEfforts& run) {
  PairTable table{.run = &run, .handovers = {}, .refusals = {}};
  const Scenario& scenario = run.trace.scenario;
  for (const msg::SwapOutcome& swap : run.trace.swaps) {
    const int from = controllerIndex(scenario, swap.outgoing().c_str());
    const int to = controllerIndex(scenario, swap.incoming().c_str());
    if (from < 0 || to < 0 || swap.plan_id() == 0) continue;
    table.handovers.push_back(
        handoverOf(run, static_cast<std::size_t>(from), static_cast<std::size_t>(to), swap.at_step()));
  }
  for (const msg::SwapOutcome& swap : run.refused) {
    const int to = controllerIndex(scenario, swap.incoming().c_str());
    const std::uint64_t k = swap.decided_at_step() - run.trace.first_step;
    if (to < 0 || k >= run.holder.size() || run.holder[k] < 0) continue;
    table.refusals.push_back({static_cast<std::size_t>(run.holder[k]), static_cast<std::size_t>(to),
                              swap.decided_at_step(), swap.reason().c_str()});
  }
  return table;
}

std::vector<Check> checksOf(const PairTable& table) {
  const RecordedEfforts& run = *table.run;
  const std::vector<ControllerConfig>& controllers = run.trace.scenario.controllers;
  std::set<Pair> done, refused;
  double excess = 0.0, missing = 0.0, hits = 0.0, touching = 0.0, fastest = 0.0, standing = 0.0;
  for (const PairHandover& one : table.handovers) {
    done.insert({one.from, one.to});
    if (one.has_report && !one.cut_short && !one.change.hasNaN() && !one.own.hasNaN()) {
      excess = std::max(excess, one.excess());
      hits += static_cast<double>(one.rate_limit_hits);
    } else {
      missing += 1.0;
    }
    touching += one.touches ? 1.0 : 0.0;
    fastest = std::max(fastest, one.tip_speed);
    standing += one.tip_speed < kAtRest ? 1.0 : 0.0;
  }
  for (const PairRefusal& one : table.refusals) refused.insert({one.from, one.to});

  const auto n = static_cast<double>(controllers.size());
  const auto handovers = static_cast<double>(table.handovers.size());
  const bool is_contact = 2.0 * touching > handovers;
  const auto unfit = static_cast<double>(std::count_if(controllers.begin(), controllers.end(), [&](const auto& one) {
    return !is_contact && findLaw(one.law).requires_contact;
  }));
  std::vector<Check> checks;
  checks.push_back(count("laws", static_cast<double>(allLaws().size()), [&] {
    std::set<std::string> laws;
    for (const ControllerConfig& one : controllers) laws.insert(one.law);
    return static_cast<double>(laws.size());
  }()));
  checks.push_back(
      count("ordered pairs handed over", (n - unfit) * (n - unfit - 1.0), static_cast<double>(done.size())));
  checks.push_back(count("ordered pairs refused", (n - unfit) * unfit, static_cast<double>(refused.size())));
  checks.push_back(count("handovers of which something is not recorded", 0.0, missing));
  checks.push_back({.what = "change at K beyond the larger of the laws' own, largest",
                    .unit = "N m or N",
                    .predicted = 0.0,
                    .measured = excess,
                    .tolerance = kBumpTolerance});
  checks.push_back(count("torques that changed faster than the limit", 0.0, hits));
  checks.push_back(count("steps lost", 0.0, static_cast<double>(run.lost_steps)));
  checks.push_back(count("steps doubled", 0.0, static_cast<double>(run.doubled_steps)));
  checks.push_back(count("handovers in contact", is_contact ? handovers : 0.0, touching));
  if (isReferenceAtRest(table)) {
    checks.push_back({.what = "speed of the tip at K, largest",
                      .unit = "m/s",
                      .predicted = 0.0,
                      .measured = fastest,
                      .tolerance = kAtRest});
  } else {
    checks.push_back(count("handovers with the tip at rest", 0.0, standing));
  }
  return checks;
}

}  // namespace baton
