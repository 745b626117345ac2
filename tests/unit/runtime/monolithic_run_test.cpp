/// The loop in one process by itself; that it has the bytes of the distributed system is for tests/integration.
#include "runtime/monolithic_run.hpp"

#include <gtest/gtest.h>

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
}

TEST(MonolithicRun, EndsWithAReasonWhenTheMotionIsNoLongerFinite) {
  const std::string coarse =
      replaced(replaced(kPress, "step_s: 0.0005", "step_s: 0.05"), "duration_s: 0.5", "duration_s: 1000");
  MonolithicRun run(parse(replaced(coarse, "law: impedance", "law: impedance, parameters: {kd: 300}")));
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
