/// The loop in one process by itself; that it has the bytes of the distributed system is for tests/integration.
#include "runtime/monolithic_run.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "bad_input.hpp"
#include "runtime/yaml.hpp"
#include "support/allocation_guard.hpp"

namespace baton {
namespace {

using test::refusal;
using test::replaced;
using test::rppScenario;

const char* const kPress = R"(name: press
robot: rpp.yaml
step_s: 0.0005
substeps: 2
duration_s: 0.5
start: {position: [0.52, 0.2, 0.1]}
environment:
  walls: [{point_m: [0, 0, 0.7], normal: [0, 0, 1], stiffness_N_per_m: 200}]
trajectory:
  waypoints: [{time_s: 0, position: [pi/6, 0.2, 0.1]}]
controllers:
  - {name: soft, law: impedance}
  - {name: stiff, law: operational_inverse_dynamics}
active: soft
)";

Scenario parse(const std::string& text) { return rppScenario("press.yaml", text); }

std::uint64_t hashOf(const std::string& text) {
  MonolithicRun run(parse(text));
  while (run.step()) {
  }
  EXPECT_EQ(run.failure(), "");
  EXPECT_EQ(run.steps(), run.scenario().end_step);
  return run.chainHash();
}

TEST(MonolithicRun, IsTheSameTwiceAndTellsOneBitApart) {
  const std::uint64_t hash = hashOf(kPress);
  EXPECT_EQ(hashOf(kPress), hash);
  EXPECT_NE(hashOf(replaced(kPress, "stiffness_N_per_m: 200", "stiffness_N_per_m: 200.00000000000003")), hash);
  EXPECT_NE(hashOf(replaced(kPress, "active: soft", "active: stiff")), hash);
  EXPECT_NE(hashOf(replaced(kPress, "duration_s: 0.5", "duration_s: 0.4995")), hash);
  for (const char* coupling : {"held", "late"}) {
    const std::string coupled = std::string("environment:\n  coupling: ") + coupling + "\n";
    EXPECT_NE(hashOf(replaced(kPress, "environment:\n", coupled)), hash) << coupling;
  }
}

TEST(MonolithicRun, IsNotChangedByWhoStandsBy) {
  const std::string alone = replaced(kPress, "  - {name: stiff, law: operational_inverse_dynamics}\n", "");
  EXPECT_EQ(hashOf(alone), hashOf(kPress));
}

TEST(MonolithicRun, ComesToRestWhereTheSpringsAreInBalance) {
  // Kp (z_d - z) = Ke (z - z_r) with Kp = Ke = 200 N/m: half way in.
  MonolithicRun run(parse(replaced(kPress, "duration_s: 0.5", "duration_s: 4")));
  while (run.step()) {
  }
  EXPECT_NEAR(run.state().X_WE.p.z(), 0.7125, 1e-6);
}

TEST(MonolithicRun, RefusesWhatNeedsMoreThanOneLoop) {
  const std::string swap = replaced(kPress, "active: soft\n", "active: soft\nswaps: [{at_s: 0.2, to: stiff}]\n");
  EXPECT_NE(refusal([&] { MonolithicRun run(parse(swap)); }).find("without swaps"), std::string::npos);
  const std::string realtime = replaced(kPress, "duration_s: 0.5\n", "duration_s: 0.5\nmode: realtime\n");
  EXPECT_NE(refusal([&] { MonolithicRun run(parse(realtime)); }).find("lockstep"), std::string::npos);
  const auto refusalOf = [](const std::string& plan) {
    return refusal([&] { MonolithicRun run(parse(kPress + plan)); });
  };
  const std::string fault = refusalOf("faults: [{do: kill, service: stiff, at_s: 0.2}]\n");
  EXPECT_NE(fault.find("expected a scenario without faults"), std::string::npos) << fault;
  EXPECT_NE(fault.find("found kill of stiff; run it as processes"), std::string::npos) << fault;
  const std::string stop = refusalOf("stops: [{decided_at_s: 0.1, at_s: 0.2}]\n");
  EXPECT_NE(stop.find("expected a scenario without stops"), std::string::npos) << stop;
  EXPECT_NE(stop.find("found one at step 400"), std::string::npos) << stop;
}

/// From step 200 on the holder commands far more than it may, as it pushes into the wall.
const std::string kTooMuch = "changes: [{at_s: 0.1, controller: soft, set: {kp: 1.0e+7}}]\n";

TEST(MonolithicRun, TakesTheBatonFromWhoCommandsTooMuch) {
  MonolithicRun run(parse(kPress + kTooMuch + "baton: {max_command: 1000}\n"));
  JointVector before;
  while (run.step()) {
    if (run.steps() == 200) before = run.state().tau_applied;
    if (run.steps() == 201) {
      EXPECT_EQ(run.state().tau_applied, before) << "a refused command moves nothing";
    }
  }
  EXPECT_EQ(run.failure(), "");
  EXPECT_EQ(run.steps(), run.scenario().end_step) << "the brake holds to the end";
  ASSERT_EQ(run.failovers().size(), 1U);
  const msg::SwapOutcome& failover = run.failovers().front();
  EXPECT_STREQ(failover.outgoing().c_str(), "soft");
  EXPECT_STREQ(failover.incoming().c_str(), "");
  EXPECT_EQ(failover.at_step(), 201U);
  EXPECT_NE(run.whatWentWrong().find("soft lost the baton: failover: it commanded"), std::string::npos);
  EXPECT_NE(run.whatWentWrong().find("above the scenario's max_command of 1000 at step 200"), std::string::npos);
  EXPECT_LT(run.state().qd.cwiseAbs().maxCoeff(), 0.01);
}

TEST(MonolithicRun, TheFallbackTakesOverWithoutAJump) {
  MonolithicRun run(parse(kPress + kTooMuch + "baton: {max_command: 1000, fallback: [stiff]}\n"));
  while (run.step()) {
  }
  EXPECT_EQ(run.failure(), "");
  ASSERT_EQ(run.failovers().size(), 1U);
  const msg::SwapOutcome& failover = run.failovers().front();
  EXPECT_STREQ(failover.incoming().c_str(), "stiff");
  ASSERT_EQ(failover.raw_effort_step().size(), 3U);
  ASSERT_EQ(failover.applied_effort_step().size(), 3U);
  double raw = 0.0, applied = 0.0;
  for (const double step : failover.raw_effort_step()) raw = std::max(raw, std::abs(step));
  for (const double step : failover.applied_effort_step()) applied = std::max(applied, std::abs(step));
  EXPECT_GT(raw, 0.1);
  EXPECT_LT(applied, 1e-9) << "the blend takes all of it";
}

TEST(MonolithicRun, EndsWithAReasonWhenTheMotionIsNoLongerFinite) {
  const std::string coarse =
      replaced(replaced(kPress, "step_s: 0.0005", "step_s: 0.05"), "duration_s: 0.5", "duration_s: 1000");
  Scenario scenario = parse(replaced(coarse, "law: impedance", "law: impedance, parameters: {kd: 300}"));
  scenario.baton.max_command = std::numeric_limits<double>::infinity();
  MonolithicRun run(scenario);
  while (run.step()) {
  }
  EXPECT_NE(run.failure(), "");
  EXPECT_LT(run.steps(), run.scenario().end_step);
  const std::uint64_t steps = run.steps();
  EXPECT_FALSE(run.step());
  EXPECT_EQ(run.steps(), steps);
}

TEST(MonolithicRun, NeverAllocatesInAStep) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  MonolithicRun run(parse(kPress));
  const test::AllocationGuard guard;
  while (run.step()) {
  }
  EXPECT_EQ(guard.count(), 0u);
}

}  // namespace
}  // namespace baton
