/// What the meter says of handovers whose measures are known.
#include "control/handover_meter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "control/arm.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

constexpr double kStep_s = 0.001;
const JointVector kLimit = Vector3(1000.0, 1000.0, 10.0);

HandoverStep still() {
  return {.tau_before = JointVector::Zero(3),
          .tau = JointVector::Zero(3),
          .residual = JointVector::Zero(3),
          .dq = JointVector::Zero(3),
          .f_e = Vector3::Zero()};
}

TEST(HandoverMeter, CountsEveryJointThatChangesFasterThanItsLimit) {
  HandoverMeter meter(kStep_s, kLimit);
  meter.start(10, 3);
  HandoverStep step = still();
  step.tau = Vector3(1.0, -1.5, 0.0);  // 1000, which is allowed, and 1500
  meter.add(step);
  step.tau_before = step.tau;
  step.tau = Vector3(0.0, 0.5, 0.02);  // 1000, 2000, 20
  meter.add(step);
  EXPECT_EQ(meter.measure().rate_limit_hits, 3u);
  EXPECT_EQ(meter.measure().at_step, 10u);
  EXPECT_EQ(meter.measure().steps, 2u);
  EXPECT_NEAR(meter.measure().max_effort_rate(1), 2000.0, 1e-9);
  EXPECT_NEAR(meter.measure().max_effort_rate(2), 20.0, 1e-12);
}

TEST(HandoverMeter, TheForceDeviatesFromThatOfTheFirstStep) {
  HandoverMeter meter(kStep_s, kLimit);
  meter.start(0, 10);
  HandoverStep step = still();
  for (const double f : {5.0, 7.0, 1.0, 5.0}) {
    step.f_e = Vector3(0.0, 0.0, f);
    meter.add(step);
  }
  EXPECT_EQ(meter.measure().peak_force_deviation, 4.0);
}

TEST(HandoverMeter, RunsForAsLongAsItWasToldAndOneStepAtLeast) {
  HandoverMeter meter(kStep_s, kLimit);
  EXPECT_FALSE(meter.isRunning());
  meter.add(still());
  EXPECT_EQ(meter.measure().steps, 0u);
  for (const std::uint64_t steps : {0u, 1u, 5u}) {
    meter.start(3, steps);
    std::uint64_t added = 0;
    for (; meter.isRunning(); ++added) meter.add(still());
    EXPECT_EQ(added, std::max<std::uint64_t>(steps, 1));
    EXPECT_EQ(meter.measure().steps, added);
  }
}

/// Steps of an arm under a blend, added to a meter.
struct BlendedArm {
  explicit BlendedArm(const RobotModel& robot)
      : arm(robot, {.step_s = kStep_s, .start_q = Vector3(0.4, 0.1, 0.1), .start_qd = Vector3(0.2, -0.1, 0.05)}),
        meter(kStep_s, kLimit) {}
  void step(std::uint64_t k) {
    HandoverStep one = still();
    const JointVector q = arm.state().q;
    one.tau_before = arm.state().tau_applied;
    one.residual = arm.residual(k);
    ASSERT_TRUE(arm.move(arm.blended(k, arm.brakeEffort()), Contact{}));
    one.tau = arm.state().tau_applied;
    one.dq = arm.state().q - q;
    work += one.residual.dot(one.dq);
    meter.add(one);
  }
  Arm arm;
  HandoverMeter meter;
  double work = 0.0;  // of the blend's torque
};

TEST(HandoverMeter, TheBlendsEnergyIsTheWorkThatItAddsToTheArm) {
  // A torque held over a step does the work tau . dq in it, exactly. So the blend's share is the sum of its own, and a
  // blend of the opposite sign does about the opposite as long as it hardly changes the motion.
  const RobotModel robot = test::rppRobot();
  const JointVector r0 = Vector3(1e-4, -2e-4, 1e-5);
  std::array<double, 2> energy{};
  for (const double sign : {1.0, -1.0}) {
    BlendedArm blended(robot);
    blended.arm.blendFrom(0, 100, sign * r0);
    blended.meter.start(0, 100);
    for (std::uint64_t k = 0; k < 120; ++k) blended.step(k);
    EXPECT_FALSE(blended.meter.isRunning());
    EXPECT_EQ(blended.meter.measure().blend_energy, blended.work);
    energy[sign > 0.0 ? 0 : 1] = blended.work;
  }
  EXPECT_NE(energy[0], 0.0);
  EXPECT_NEAR(energy[0], -energy[1], 0.01 * std::abs(energy[0]));
}

TEST(HandoverMeter, GoesOnFromACheckpointWithTheSameNumbers) {
  const RobotModel robot = test::rppRobot();
  BlendedArm whole(robot);
  whole.arm.blendFrom(0, 50, Vector3(1.0, 2.0, 0.1));
  whole.meter.start(0, 50);
  std::array<std::byte, 1024> bytes{};
  std::size_t size = 0;
  for (std::uint64_t k = 0; k < 50; ++k) {
    if (k == 20) {
      StateArchive saved = StateArchive::into(bytes);
      whole.arm.archive(saved);
      whole.meter.archive(saved);
      ASSERT_TRUE(saved.isGood());
      size = saved.size();
    }
    whole.step(k);
  }
  BlendedArm rest(robot);
  StateArchive saved = StateArchive::from(std::span(bytes).first(size));
  rest.arm.archive(saved);
  rest.meter.archive(saved);
  ASSERT_TRUE(saved.isWhole());
  for (std::uint64_t k = 20; k < 50; ++k) rest.step(k);
  const HandoverMeasure& a = whole.meter.measure();
  const HandoverMeasure& b = rest.meter.measure();
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.blend_energy, b.blend_energy);
  EXPECT_EQ(a.max_effort_rate, b.max_effort_rate);
  EXPECT_FALSE(rest.meter.isRunning());

  HandoverMeter other(kStep_s, JointVector::Ones(2));
  StateArchive wrong = StateArchive::from(std::span(bytes).first(size));
  other.archive(wrong);
  EXPECT_FALSE(wrong.isWhole());
}

}  // namespace
}  // namespace baton
