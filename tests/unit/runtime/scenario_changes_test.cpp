/// Changes of parameters in a scenario: planned in any order, checked with what is in force by then.
#include <gtest/gtest.h>

#include "bad_input.hpp"
#include "runtime/monolithic_run.hpp"
#include "runtime/yaml.hpp"
#include "support/allocation_guard.hpp"

namespace baton {
namespace {

using test::refusal;
using test::rppScenario;

const std::string kHold = R"(name: hold
robot: rpp.yaml
step_s: 0.0005
duration_s: 0.1
environment: {walls: [{point_m: [0, 0, 0.7], normal: [0, 0, 1], stiffness_N_per_m: 200}]}
trajectory: {waypoints: [{time_s: 0, position: [0.1, 0.1, 0.1]}]}
controllers:
  - {name: soft, law: impedance}
  - {name: pd, law: joint_pd, parameters: {kp: 30}}
active: soft
)";

Scenario parse(const std::string& changes) { return rppScenario("hold.yaml", kHold + "changes:\n" + changes); }

std::uint64_t hashOf(const Scenario& scenario) {
  MonolithicRun run(scenario);
  while (run.step()) {
  }
  EXPECT_EQ(run.failure(), "");
  return run.chainHash();
}

TEST(ScenarioChanges, AreReadInTheOrderOfTheirStepsWithWholeValues) {
  const Scenario s = parse(
      "  - {at_s: 0.02, controller: pd, set: {kp: [1, 2, 3], kd: pi}}\n"
      "  - {at_s: 0.01, controller: soft, set: {form: no_force}}\n");
  ASSERT_EQ(s.changes.size(), 2u);
  EXPECT_EQ(s.changes[0].controller, "soft");
  EXPECT_EQ(s.changes[0].change.at_step, 20u);
  EXPECT_EQ(choice(s.changes[0].change.set, "form"), "no_force");
  EXPECT_EQ(s.changesOf("pd").at(0).at_step, 40u);
  EXPECT_EQ(numbers(s.changesOf("pd").at(0).set, "kp"), (std::vector{1.0, 2.0, 3.0}));
  EXPECT_EQ(numbers(s.changesOf("pd").at(0).set, "kd").size(), 3u);
  EXPECT_EQ(numbers(s.controller("pd").parameters, "kp"), std::vector<double>(3, 30.0)) << "the start stays";
  EXPECT_TRUE(s.warnings.empty());
  EXPECT_EQ(parse("  - {at_s: 0.1, controller: pd, set: {kp: 1}}\n").warnings.size(), 1u) << "after the end";
}

TEST(ScenarioChanges, AreRefusedWithTheirLine) {
  const auto message = [](const std::string& change) { return refusal([&] { return parse("  - " + change + "\n"); }); };
  for (const auto& [change, word] : std::vector<std::pair<std::string, std::string>>{
           {"{at_s: 0.01, controller: nobody, set: {kp: 1}}", "nobody"},
           {"{at_s: 0.01, controller: pd, set: {kq: 1}}", "kq"},
           {"{at_s: 0.01, controller: pd, set: {kp: -1}}", "expected numbers >= 0"},
           {"{at_s: 0.01, controller: pd, set: {kp: [1, 2]}}", "1 or 3 numbers"},
           {"{at_s: 0.01, controller: soft, set: {form: printed}}", "one of corrected"},
           {"{at_s: 0.01, controller: pd, set: {}}", "a parameter to change"},
           {"{at_s: 0.0103, controller: pd, set: {kp: 1}}", "a whole number of steps"},
           {"{at_s: 0.01, controller: pd}", "set"}}) {
    EXPECT_NE(message(change).find(word), std::string::npos) << message(change);
    EXPECT_NE(message(change).find("hold.yaml:12"), std::string::npos) << message(change);
  }
}

TEST(ScenarioChanges, ChangeTheRunFromTheirStepOnWithoutAllocating) {
  const std::uint64_t without = hashOf(parse("  []\n"));
  EXPECT_NE(hashOf(parse("  - {at_s: 0.05, controller: soft, set: {kp: 300}}\n")), without);
  EXPECT_EQ(hashOf(parse("  - {at_s: 0.05, controller: soft, set: {kp: 200}}\n")), without) << "the value it has";
  EXPECT_EQ(hashOf(parse("  - {at_s: 0.05, controller: pd, set: {kp: 300}}\n")), without) << "stands by";
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  MonolithicRun run(parse("  - {at_s: 0.05, controller: soft, set: {kp: 300}}\n"));
  const test::AllocationGuard guard;
  while (run.step()) {
  }
  EXPECT_EQ(guard.count(), 0u);
}

}  // namespace
}  // namespace baton
