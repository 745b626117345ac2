// A handover that makes a bump is seen, and so is one of which something is missing.
#include "report/pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "support/processes.hpp"

namespace baton::test {
namespace {

constexpr std::uint64_t kAt = 3;  // K of the one handover

/// Ten steps under the laws of free_rest, all of 1 N m or N and at one place, and a handover from the first to the
/// second.
RecordedEfforts quietRun() {
  RecordedEfforts run;
  run.trace.scenario = loadScenario((deployFolder() / "scenarios/handover/free_rest.yaml").string());
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(3, 10), one = Eigen::MatrixXd::Ones(3, 10);
  run.trace.q = run.trace.qd = run.trace.qd_d = run.trace.p_WE = zero;
  run.trace.h_e = Eigen::MatrixXd::Zero(6, 10);
  run.trace.tau = one;
  run.effort.assign(10, one);
  run.holder.assign(10, 1);
  std::fill_n(run.holder.begin(), kAt, 0);
  msg::SwapOutcome swap;
  swap.done(true);
  swap.plan_id(1);
  swap.outgoing(run.trace.scenario.controllers[0].name);
  swap.incoming(run.trace.scenario.controllers[1].name);
  swap.at_step(kAt);
  run.trace.swaps.push_back(swap);
  msg::SwapReport report;
  report.plan_id(1);
  report.at_step(kAt);
  report.max_effort_rate({500.0, 0.0, 0.0});
  run.reports.push_back(report);
  return run;
}

Check checkOf(const RecordedEfforts& run, const std::string& what) {
  for (const Check& check : checksOf(pairsOf(run))) {
    if (check.what == what) return check;
  }
  ADD_FAILURE() << "no check of " << what;
  return {};
}

constexpr const char* kBump = "change at K beyond the larger of the laws' own, largest";
constexpr const char* kMissing = "handovers of which something is not recorded";

TEST(Pairs, AQuietHandoverMakesNoBump) {
  const RecordedEfforts run = quietRun();
  const PairTable table = pairsOf(run);
  ASSERT_EQ(table.handovers.size(), 1U);
  EXPECT_EQ(table.handovers[0].ratio(), 0.0);
  EXPECT_EQ(table.handovers[0].rate_share, 0.5) << "500 of 1000 N m/s";
  EXPECT_TRUE(checkOf(run, kBump).passes());
  EXPECT_TRUE(checkOf(run, kMissing).passes());
  EXPECT_TRUE(checkOf(run, "laws").passes());
  const Check pairs = checkOf(run, "ordered pairs handed over");
  EXPECT_EQ(pairs.predicted, 72.0) << "of nine laws";
  EXPECT_EQ(pairs.measured, 1.0);
  EXPECT_FALSE(pairs.passes());
}

TEST(Pairs, AChangeMayBeAsLargeAsThatOfTheLawsAndNoLarger) {
  RecordedEfforts run = quietRun();
  run.trace.tau(1, kAt + 1) += 0.25;  // tau(K)
  EXPECT_FALSE(checkOf(run, kBump).passes());
  EXPECT_DOUBLE_EQ(checkOf(run, kBump).measured, 0.25);
  EXPECT_GT(pairsOf(run).handovers[0].ratio(), 1e6);

  RecordedEfforts outgoing = run, incoming = run, elsewhere = run;
  outgoing.effort[0](1, kAt - 1) -= 0.25;
  EXPECT_TRUE(checkOf(outgoing, kBump).passes());
  incoming.effort[1](1, kAt + 1) -= 0.25;
  EXPECT_TRUE(checkOf(incoming, kBump).passes());
  elsewhere.effort[1](0, kAt + 1) -= 0.25;
  EXPECT_FALSE(checkOf(elsewhere, kBump).passes()) << "another joint's change excuses nothing";
}

TEST(Pairs, WhatIsMissingIsNoGoodHandover) {
  RecordedEfforts run = quietRun();
  run.effort[1](2, kAt + 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(checkOf(run, kMissing).passes());
  run = quietRun();
  run.reports.clear();
  EXPECT_FALSE(checkOf(run, kMissing).passes());
  run = quietRun();
  run.reports[0].cut_short(true);
  EXPECT_FALSE(checkOf(run, kMissing).passes());
}

TEST(Pairs, HitsLostStepsAndMotionAreCounted) {
  RecordedEfforts run = quietRun();
  run.reports[0].rate_limit_hits(2);
  run.lost_steps = 1;
  run.doubled_steps = 3;
  run.trace.p_WE(0, kAt + 1) += 1e-4;  // in 0.5 ms
  EXPECT_EQ(checkOf(run, "torques that changed faster than the limit").measured, 2.0);
  EXPECT_EQ(checkOf(run, "steps lost").measured, 1.0);
  EXPECT_EQ(checkOf(run, "steps doubled").measured, 3.0);
  EXPECT_NEAR(checkOf(run, "speed of the tip at K, largest").measured, 0.2, 1e-9);
}

TEST(Pairs, TheTableShowsWhatWasRefusedAndWhy) {
  RecordedEfforts run = quietRun();
  msg::SwapOutcome refused;
  refused.incoming("force_pi");
  refused.decided_at_step(kAt + 2);
  refused.reason("the tip touches <nothing>");
  run.refused.push_back(refused);
  EXPECT_EQ(checkOf(run, "ordered pairs refused").measured, 1.0);
  const std::string html = toHtml(pairsOf(run));
  EXPECT_NE(html.find("refused</span> 1 times: the tip touches &lt;nothing&gt;"), std::string::npos) << html;
  EXPECT_NE(html.find("joint_pd to joint_inverse_dynamics at step 3"), std::string::npos);
  EXPECT_NE(html.find("never held"), std::string::npos);
}

}  // namespace
}  // namespace baton::test
