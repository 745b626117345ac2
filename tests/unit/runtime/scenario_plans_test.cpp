// What a scenario plans for the baton beside plain handovers: their options, failures and stops.
#include <gtest/gtest.h>

#include "bad_input.hpp"
#include "runtime/monolithic_run.hpp"
#include "runtime/scenario.hpp"
#include "runtime/scenario_edit.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

using test::BadInput;
using test::refusal;
using test::replaced;
using test::rppScenario;

const char* const kPlans = R"(name: plans
robot: rpp.yaml
step_s: 0.001
duration_s: 2
trajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}
controllers:
  - {name: a, law: joint_pd}
  - {name: b, law: joint_inverse_dynamics}
  - {name: c, law: adaptive}
active: a
failures:
  - {controller: c, returns_at_s: 0.3}
  - {controller: a, at_s: 0.2}
  - {controller: c, at_s: 0.5, commanded: false, returns_at_s: 0.5, restarted: true}
swaps:
  - {at_s: 0.4, to: b, force: true, blend_s: 0.0504}
  - {at_s: 0.7, to: c, hard: true}
  - {at_s: 0.713, to: b}
  - {at_s: 0.714, to: b, expect: any}
stops:
  - {decided_at_s: 0.9, at_s: 1.5}
  - {decided_at_s: 0.9, at_s: 1.2}
baton: {blend_s: 0.1}
)";

Scenario parse(const std::string& text) { return rppScenario("plans.yaml", text); }

TEST(ScenarioPlans, GivesEachFieldItsPlace) {
  const Scenario s = parse(kPlans);
  ASSERT_EQ(s.swaps.size(), 4U);
  EXPECT_TRUE(s.swaps[0].force);
  EXPECT_EQ(s.swaps[0].blend_steps, 50U) << "to the nearest step";
  EXPECT_TRUE(s.swaps[1].hard);
  EXPECT_FALSE(s.swaps[1].blend_steps);
  EXPECT_FALSE(s.swaps[2].force || s.swaps[2].hard || s.swaps[2].blend_steps);
  EXPECT_EQ(s.swaps[2].expect, SwapExpectation::kDone);
  EXPECT_EQ(s.swaps[3].expect, SwapExpectation::kAny);

  ASSERT_EQ(s.failures.size(), 3U);
  EXPECT_FALSE(s.failures[0].at_step);
  EXPECT_EQ(s.failures[0].returns_at_step, 300U);
  EXPECT_EQ(s.failures[1].at_step, 200U);
  EXPECT_EQ(s.failures[1].controller, "a");
  EXPECT_TRUE(s.failures[1].commanded) << "its last command counts unless the file says otherwise";
  EXPECT_FALSE(s.failures[1].returns_at_step);
  EXPECT_FALSE(s.failures[2].commanded);
  EXPECT_TRUE(s.failures[2].restarted);

  ASSERT_EQ(s.stops.size(), 2U);
  EXPECT_EQ(s.stops[1].decided_at_step, 900U);
  EXPECT_EQ(s.stops[1].at_step, 1200U);
}

TEST(ScenarioPlans, WhatMayBeRefusedIsNotForeseen) {
  const std::string plain = replaced(kPlans, ", expect: any", "");
  EXPECT_NE(refusal([&] { return parse(plain); }).find("swaps[3].at_s: expected a time not before"), std::string::npos);
  const std::string early = replaced(kPlans, "at_s: 0.4, to: b, force: true", "at_s: 0.006, to: a, expect: any");
  EXPECT_EQ(parse(early).swaps[0].at_step, 6U) << "asked for at step 0, margin 5";
  EXPECT_NE(refusal([&] { return parse(replaced(early, "0.006", "0.005")); }).find("margin_steps + 1"),
            std::string::npos);
}

TEST(ScenarioPlans, OneProcessHasNobodyToLose) {
  const std::string text = R"(name: alone
robot: rpp.yaml
step_s: 0.001
trajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}
controllers: [{name: a, law: joint_pd}]
active: a
failures: [{controller: a, at_s: 0.2}]
)";
  EXPECT_NE(refusal([&] { MonolithicRun run(parse(text)); }).find("without failures"), std::string::npos);
}

TEST(ScenarioPlans, MoreEntriesGoToTheEndOfAListThatIsMadeWhenMissing) {
  const std::string more = appendToScenario(kPlans, "failures", {"{controller: b, at_s: 0.6}"});
  ASSERT_EQ(parse(more).failures.size(), 4U);
  EXPECT_EQ(parse(more).failures[3].at_step, 600U);
  const std::string none = "active: a\n";
  EXPECT_EQ(appendToScenario(none, "failures", {}), none);
  EXPECT_EQ(
      parse(appendToScenario(editScenario(kPlans, {{"failures", "[]"}}), "failures", {"{controller: b, at_s: 0.6}"}))
          .failures.size(),
      1U);
}

class BadPlan : public testing::TestWithParam<BadInput> {};

TEST_P(BadPlan, IsRefusedWithItsPlace) {
  const std::string text = replaced(kPlans, GetParam().from, GetParam().to);
  test::expectMessage(refusal([&] { return parse(text); }), "plans.yaml", text, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadPlan,
    testing::Values(
        BadInput{"BlendOfAHardOne", "hard: true", "hard: true, blend_s: 0.1", "hard: true", "which has no blend", ""},
        BadInput{"LongBlend", "blend_s: 0.0504", "blend_s: 11", "blend_s: 11", "from 0 to 10 s", "'11'"},
        BadInput{"Perhaps", "force: true", "force: perhaps", "perhaps", "true or false", "'perhaps'"},
        BadInput{"BehindAShortBlend", "at_s: 0.713", "at_s: 0.712", "at_s: 0.712", "not before step 713", "'0.712'"},
        BadInput{"NobodyFails", "controller: a, at_s", "controller: d, at_s", "controller: d", "'d'", "'d'"},
        BadInput{"OutOfOrder", "controller: a, at_s: 0.2", "controller: a, at_s: 0.6", "controller: c, at_s: 0.5",
                 "in the order of their times", "'0.5'"},
        BadInput{"NoTimeBehindOne", "controller: c, at_s: 0.5, commanded: false,", "controller: b,", "controller: b,",
                 "those without one first", ""},
        BadInput{"FailsTwice", "at_s: 0.5, commanded", "at_s: 0.25, commanded", "at_s: 0.25", "that has returned",
                 "'c'"},
        BadInput{"ReturnsBeforeItFails", "returns_at_s: 0.5", "returns_at_s: 0.4", "returns_at_s: 0.4",
                 "not before at_s", "'0.4'"},
        BadInput{"NoCommandBeforeTheFirstStep", "controller: c, returns", "controller: c, commanded: true, returns",
                 "commanded: true", "expected at_s beside it", "none"},
        BadInput{"RestartedAndNeverBack", "at_s: 0.2}", "at_s: 0.2, restarted: true}", "at_s: 0.2,",
                 "expected returns_at_s beside it", "none"},
        BadInput{"StopBeforeItWasAskedFor", "at_s: 1.2", "at_s: 0.9", "decided_at_s: 0.9, at_s: 0.9",
                 "a time after decided_at_s", "'0.9'"},
        BadInput{"StopsOutOfOrder", "decided_at_s: 0.9, at_s: 1.2", "decided_at_s: 0.8, at_s: 1.2", "decided_at_s: 0.8",
                 "not before that of the stop before", "'0.8'"}),
    [](const auto& bad) { return bad.param.name; });

TEST(ScenarioEdit, AnEmptyListIsNamedAsOne) {
  const std::string message = refusal([] { return editScenario("swaps: []\n", {{"swaps.0.to", "force"}}); });
  EXPECT_NE(message.find("the list has no entries"), std::string::npos) << message;
}

}  // namespace
}  // namespace baton
