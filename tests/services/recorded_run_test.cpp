// From a recording's decisions to the scenario that repeats it.
#include "recorded_run.hpp"

#include <gtest/gtest.h>

#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

msg::Decision decision(msg::DecisionCause cause, std::uint64_t step, std::uint64_t at_step, const char* controller) {
  msg::Decision one;
  one.cause(cause);
  one.step(step);
  one.at_step(at_step);
  one.controller(controller);
  return one;
}

RecordedRun recorded(const std::vector<msg::Decision>& decisions) {
  static const std::string robot = loadScenario((deployFolder() / "scenarios/demo.yaml").string()).robot_text;
  RecordedRun run;
  run.scenario_text = shortContact("late: {policy: abort, after_s: 1}\n");
  run.robot_text = robot;
  run.scenario = parseScenario("short.yaml", run.scenario_text, "robot.yaml", robot);
  run.last_step = 1000;
  run.decisions = decisions;
  return run;
}

Scenario repeated(const RecordedRun& run, std::uint64_t end_step) {
  return parseScenario("again.yaml", repeatingScenario(run, end_step), "robot.yaml", run.robot_text);
}

TEST(RecordedRun, RepeatsHandoversInTheOrderThePlantTakesThem) {
  msg::Decision swap = decision(msg::DECISION_SWAP, 294, 300, "pd");
  swap.force(true);
  swap.blend_steps(123);
  msg::Decision hard = decision(msg::DECISION_SWAP, 394, 400, "tracking");
  hard.hard(true);
  const Scenario again = repeated(recorded({swap, hard}), 700);
  ASSERT_EQ(again.swaps.size(), 3U) << "the one that is planned for the end is left out";
  EXPECT_EQ(again.swaps[0].to, "impedance") << "planned by the scenario, so it comes first";
  EXPECT_EQ(again.swaps[1].to, "pd");
  EXPECT_TRUE(again.swaps[1].force);
  EXPECT_EQ(again.swaps[1].blend_steps, 123U);
  EXPECT_EQ(again.swaps[2].at_step, 400U);
  EXPECT_TRUE(again.swaps[2].hard);
  for (const PlannedSwap& one : again.swaps)
    EXPECT_EQ(one.expect, SwapExpectation::kAny) << "what was refused is refused again";
  EXPECT_EQ(again.end_step, 700U);
  EXPECT_EQ(again.late_policy, LatePolicy::kWait) << "no timer decides";
}

TEST(RecordedRun, PairsFailuresWithReturns) {
  msg::Decision lost = decision(msg::DECISION_FAILED, 200, 201, "tracking");
  lost.commanded(true);
  msg::Decision back = decision(msg::DECISION_RETURNED, 260, 260, "tracking");
  back.restarted(true);
  const Scenario again = repeated(
      recorded({decision(msg::DECISION_FAILED, 0, 0, "force"), lost, decision(msg::DECISION_FAILED, 250, 251, "pd"),
                back, decision(msg::DECISION_FAILED, 260, 261, "tracking")}),
      1000);
  ASSERT_EQ(again.failures.size(), 4U);
  EXPECT_FALSE(again.failures[0].at_step) << "it had failed before the first step";
  EXPECT_EQ(again.failures[1].at_step, 200U);
  EXPECT_TRUE(again.failures[1].commanded);
  EXPECT_EQ(again.failures[1].returns_at_step, 260U);
  EXPECT_TRUE(again.failures[1].restarted);
  EXPECT_FALSE(again.failures[2].commanded);
  EXPECT_FALSE(again.failures[2].returns_at_step);
  EXPECT_EQ(again.failures[3].at_step, 260U);
}

TEST(RecordedRun, AHandoverToOneThatFailedInTheStepOfItsPlanLeavesNoTrace) {
  const RecordedRun run =
      recorded({decision(msg::DECISION_SWAP, 100, 106, "pd"), decision(msg::DECISION_FAILED, 100, 101, "pd"),
                decision(msg::DECISION_RETURNED, 100, 100, "pd")});
  EXPECT_EQ(swapsOf(run).size(), run.scenario.swaps.size());
}

TEST(RecordedRun, RepeatsRequestsToEndButNotTheEndHere) {
  const Scenario again =
      repeated(recorded({decision(msg::DECISION_END, 500, 900, ""), decision(msg::DECISION_END, 600, 600, "")}), 608);
  ASSERT_EQ(again.stops.size(), 1U);
  EXPECT_EQ(again.stops[0].decided_at_step, 500U);
  EXPECT_EQ(again.stops[0].at_step, 900U);
}

TEST(RecordedRun, TimesAreExact) {
  Scenario scenario;
  scenario.step_ns = 333'333;
  EXPECT_EQ(secondsText(3, scenario), "0.000999999");
  EXPECT_EQ(secondsText(3'000'000'000, scenario), "999999.000000000");
}

}  // namespace
}  // namespace baton::test
