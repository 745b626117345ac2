/// Which of its functions a law is called with at a step.
#include "runtime/running_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bad_input.hpp"
#include "robot/kinematics.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

using test::rppScenario;

/// A law that integrates, whose damping changes at step 30, and which returns as a new process at step 40.
const char* const kScenario = R"(name: press
robot: rpp.yaml
step_s: 0.0005
duration_s: 0.5
environment:
  walls: [{point_m: [0, 0, 0.7], normal: [0, 0, 1], stiffness_N_per_m: 200}]
trajectory:
  waypoints: [{time_s: 0, position: [pi/6, 0.2, 0.1]}]
controllers:
  - {name: force, law: force_pi, parameters: {kd: 30}}
  - {name: other, law: joint_pd}
active: other
failures: [{controller: force, at_s: 0.005, returns_at_s: 0.02, restarted: true}]
changes: [{at_s: 0.015, controller: force, set: {kd: 40}}]
)";

class RunningLawTest : public ::testing::Test {
 protected:
  RunningLawTest() {
    input.dt_s = scenario.stepSeconds();
    input.state.q = Vector3(0.5, 0.2, 0.1);
    input.state.qd = Vector3(0.1, -0.1, 0.2);
    input.state.X_WE = tipPose(scenario.robot, input.state.q);
    input.state.V_WE.setConstant(0.05);
    input.state.tau_applied = Vector3(1.0, 2.0, 3.0);
    input.reference.has_task = true;
    input.reference.X_WE = input.state.X_WE;
    input.reference.h_d(2) = 3.0;
    input.contact.h_e(2) = 2.0;
    input.contact.penetration = 0.01;
  }
  /// A step, with its changes.
  JointVector effort(RunningLaw& law, std::uint64_t step, const RunningLaw::Role& role) const {
    JointVector tau = JointVector::Zero(3);
    law.advance(step);
    EXPECT_EQ(law.compute(step, role, input, tau), LawStatus::kOk);
    return tau;
  }
  JointVector stepOf(Law& law) const {
    JointVector tau = JointVector::Zero(3);
    EXPECT_EQ(law.step(input, tau), LawStatus::kOk);
    return tau;
  }
  [[nodiscard]] RunningLaw made() const { return {scenario, scenario.controllers[0], 0}; }
  [[nodiscard]] std::unique_ptr<Law> bare(double kd = 30.0) const {
    auto law = makeLaw("force_pi", scenario.robot, {{"kd", std::vector{kd}}});
    law->reset();
    return law;
  }

  const Scenario scenario = rppScenario("press.yaml", kScenario);
  LawInput input;
  static constexpr RunningLaw::Role kHolds{.holds = true}, kStandsBy{};
};

TEST_F(RunningLawTest, WhoStandsByTakesOverAtEveryStep) {
  RunningLaw law = made();
  const auto bare_law = bare();
  bare_law->handover(input);
  const JointVector forecast = stepOf(*bare_law);
  for (std::uint64_t step = 0; step < 5; ++step) EXPECT_EQ(effort(law, step, kStandsBy), forecast) << step;
  EXPECT_EQ(effort(law, 5, kHolds), forecast) << "the first step with the baton";
  EXPECT_TRUE(law.isActive());
  const JointVector second = stepOf(*bare_law);
  EXPECT_NE(second, forecast);
  EXPECT_EQ(effort(law, 6, kHolds), second) << "from here on it goes on by itself";
  EXPECT_EQ(effort(law, 7, {.holds = false, .commands_once_more = true}), stepOf(*bare_law));
  EXPECT_FALSE(law.isActive());
  EXPECT_EQ(effort(law, 8, kStandsBy), forecast);
}

TEST_F(RunningLawTest, WhoBeginsARunOrForgetsHasNothingToTakeOver) {
  RunningLaw law = made();
  const auto bare_law = bare();
  const JointVector anew = stepOf(*bare_law);
  EXPECT_EQ(effort(law, 0, kHolds), anew);
  EXPECT_EQ(effort(law, 1, kHolds), stepOf(*bare_law));
  (void)effort(law, 2, kStandsBy);
  EXPECT_EQ(effort(law, 3, {.holds = true, .commands_once_more = false, .forgets = true}), anew);
}

TEST_F(RunningLawTest, TryingOutLeavesNoTrace) {
  RunningLaw law = made(), untouched = made();
  (void)effort(law, 0, kHolds);
  (void)effort(untouched, 0, kHolds);
  JointVector hard = JointVector::Zero(3), soft = hard;
  EXPECT_EQ(law.tryOut(true, input, hard), LawStatus::kOk);
  EXPECT_EQ(law.tryOut(false, input, soft), LawStatus::kOk);
  EXPECT_EQ(hard, stepOf(*bare()));
  EXPECT_NE(soft, hard);
  EXPECT_EQ(effort(law, 1, kHolds), effort(untouched, 1, kHolds));
}

TEST_F(RunningLawTest, LivesThroughWhatTheScenarioPlansAndBackToItsStart) {
  RunningLaw law = made();
  for (int take = 0; take < 2; ++take) {
    auto bare_law = bare();
    for (std::uint64_t step = 0; step < 30; ++step) ASSERT_EQ(effort(law, step, kHolds), stepOf(*bare_law)) << step;
    EXPECT_TRUE(law.advance(30));
    const JointVector changed = effort(law, 30, kHolds), unchanged = stepOf(*bare_law);
    EXPECT_NE(changed, unchanged);
    EXPECT_EQ(effort(law, 40, kHolds), stepOf(*bare(40.0))) << "a new process remembers nothing";
    law.rewind();
    EXPECT_FALSE(law.isActive());
  }
}

TEST_F(RunningLawTest, GoesOnFromASavedState) {
  RunningLaw law = made();
  for (std::uint64_t step = 0; step < 20; ++step) (void)effort(law, step, kHolds);
  std::vector<std::byte> room(8192);
  StateArchive saved = StateArchive::into(room);
  law.archive(saved);
  ASSERT_TRUE(saved.isGood());
  RunningLaw later(scenario, scenario.controllers[0], 20);
  StateArchive restored = StateArchive::from(std::span(room).first(saved.size()));
  later.archive(restored);
  EXPECT_TRUE(restored.isWhole());
  EXPECT_TRUE(later.isActive());
  for (std::uint64_t step = 20; step < 50; ++step) ASSERT_EQ(effort(later, step, kHolds), effort(law, step, kHolds));
  // Not one of another law.
  RunningLaw other(scenario, scenario.controllers[1], 20);
  StateArchive wrong = StateArchive::from(std::span(room).first(saved.size()));
  other.archive(wrong);
  EXPECT_FALSE(wrong.isGood());
}

}  // namespace
}  // namespace baton
