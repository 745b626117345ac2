// Lockstep runs of real processes: complete, exact, and the same every time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "msg/loop.h"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

using msg::JointCommand;
using msg::PlantState;

TEST(LockstepRun, TwiceGivesIdenticalPayloadsOnEveryLoopTopic) {
  const Bench bench;
  const std::string scenario = bench.write("short.yaml", shortContact());
  std::vector<Streams> runs;
  std::vector<std::string> chains;
  for (const std::string name : {"a", "b"}) {
    const std::string file = (bench.folder() / (name + ".mcap")).string();
    const nlohmann::json result = bench.batonJson({"run", scenario, "--out", file, "--json"});
    ASSERT_EQ(result.at("state"), "finished") << result;
    ASSERT_TRUE(result.at("recording").at("complete")) << result;
    chains.push_back(result.at("chain_hash"));
    runs.push_back(loopStreams(file));
  }
  // 1 state, 1 contact, 1 reference, 4 shadows, and commands of the three that held the baton.
  ASSERT_EQ(runs[0].size(), 10U);
  for (const auto& [key, payloads] : runs[0]) {
    ASSERT_TRUE(runs[1].contains(key)) << key.first << " of " << key.second;
    EXPECT_EQ(payloads, runs[1].at(key)) << key.first << " of " << key.second;
  }
  EXPECT_EQ(runs[0].size(), runs[1].size());
  EXPECT_EQ(chains[0], chains[1]);

  // Nor does the recorder change the run.
  const nlohmann::json alone = bench.batonJson({"run", scenario, "--no-recording", "--json"});
  EXPECT_EQ(alone.at("chain_hash"), chains[0]);
}

TEST(LockstepRun, RecordsEveryStepOfEveryLoopTopicOnce) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string();
  const nlohmann::json result =
      bench.batonJson({"run", bench.write("short.yaml", shortContact()), "--out", file, "--json"});
  ASSERT_EQ(result.at("exit_code"), 0) << result;
  Streams streams = loopStreams(file);

  // Every step was timed once, and together they took no longer than the run.
  const nlohmann::json& period = result.at("timing").at("period_us");
  EXPECT_EQ(period.at("count"), kShortSteps);
  EXPECT_GT(period.at("p50"), 0.0);
  EXPECT_LE(period.at("p50"), period.at("p99"));
  EXPECT_LE(period.at("p99"), period.at("max"));
  EXPECT_LE(period.at("mean").get<double>() * 1e-6 * kShortSteps, result.at("elapsed_s").get<double>());
  EXPECT_TRUE(result.at("timing").at("jitter_us").is_null());
  EXPECT_TRUE(result.at("timing").at("command_age_steps").is_null());

  const auto expectSteps = [](const auto& messages, std::uint64_t first, std::uint64_t last, const char* what) {
    ASSERT_EQ(messages.size(), last - first + 1) << what;
    for (std::size_t i = 0; i < messages.size(); ++i) {
      ASSERT_EQ(messages[i].step(), first + i) << what;
      ASSERT_EQ(messages[i].time_ns(), static_cast<std::int64_t>(first + i) * 500'000) << what;
    }
  };
  expectSteps(decodeStream<PlantState>(streams[{"plant_state", "plant"}]), 0, kShortSteps, "state");
  expectSteps(decodeStream<msg::Contact>(streams[{"contact", "environment"}]), 0, kShortSteps, "contact");
  expectSteps(decodeStream<msg::Reference>(streams[{"reference", "trajectory"}]), 0, kShortSteps + 1, "reference");
  // Each holder commands from its first step to the step at which it hands over, that one included: the plant blends
  // from its torque there.
  expectSteps(decodeStream<JointCommand>(streams[{"joint_command", "tracking"}]), 0, kFirstSwap, "tracking");
  expectSteps(decodeStream<JointCommand>(streams[{"joint_command", "impedance"}]), kFirstSwap, kSecondSwap,
              "impedance");
  expectSteps(decodeStream<JointCommand>(streams[{"joint_command", "force"}]), kSecondSwap, kShortSteps, "force");
  expectSteps(decodeStream<JointCommand>(streams[{"shadow_command", "pd"}]), 0, kShortSteps, "pd in shadow");
}

TEST(LockstepRun, HandsOverAtThePromisedStepWithoutABump) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string();
  const nlohmann::json result =
      bench.batonJson({"run", bench.write("short.yaml", shortContact()), "--out", file, "--json"});
  Streams streams = loopStreams(file);
  const auto states = decodeStream<PlantState>(streams[{"plant_state", "plant"}]);
  ASSERT_EQ(states.size(), kShortSteps + 1U);
  for (const PlantState& state : states) {
    const char* expected = state.step() < kFirstSwap ? "tracking" : state.step() < kSecondSwap ? "impedance" : "force";
    ASSERT_STREQ(state.holder().c_str(), expected) << "step " << state.step();
  }
  // The torque the joints feel changes no more at a handover than in the steps around it.
  const auto change = [&](int step, std::size_t joint) {
    return std::abs(states.at(static_cast<std::size_t>(step) + 1).applied_effort().at(joint) -
                    states.at(static_cast<std::size_t>(step)).applied_effort().at(joint));
  };
  ASSERT_EQ(result.at("swaps").size(), 2U);
  for (const int swap : {kFirstSwap, kSecondSwap}) {
    for (std::size_t joint = 0; joint < 3; ++joint) {
      double around = 0.0;
      for (int offset = 1; offset <= 3; ++offset) {
        around = std::max({around, change(swap - offset, joint), change(swap + offset, joint)});
      }
      EXPECT_LE(change(swap, joint), around + 1e-9) << "step " << swap << " joint " << joint + 1;
    }
  }
}

TEST(LockstepRun, DemoEndsWhereTheoryPutsIt) {
  const Bench bench;
  const std::string file = (bench.folder() / "demo.mcap").string();
  const nlohmann::json result = bench.batonJson({"run", "demo", "--out", file, "--json"});
  ASSERT_EQ(result.at("exit_code"), 0) << result;
  Streams streams = loopStreams(file);
  const auto states = decodeStream<PlantState>(streams[{"plant_state", "plant"}]);
  const auto contacts = decodeStream<msg::Contact>(streams[{"contact", "environment"}]);
  const auto references = decodeStream<msg::Reference>(streams[{"reference", "trajectory"}]);
  constexpr double kRelative = 1e-4;

  // Impedance at rest: Kp (x_d - x) = h_e with Kp = Ke = 200 and the goal 25 mm inside the wall; no error across it.
  const std::size_t before_force = 7999;
  const auto error = [&](std::size_t k, std::size_t axis) {
    return references.at(k).tip_position()[axis] - states.at(k).tip_position()[axis];
  };
  const double goal_depth = references.at(before_force).tip_position()[2] - 0.70;
  const double force = 200.0 * 200.0 / (200.0 + 200.0) * goal_depth;
  EXPECT_NEAR(contacts.at(before_force).force()[2], force, kRelative * force);
  EXPECT_NEAR(200.0 * error(before_force, 2), contacts.at(before_force).force()[2], kRelative * force);
  EXPECT_NEAR(error(before_force, 0), 0.0, 1e-6);
  EXPECT_NEAR(error(before_force, 1), 0.0, 1e-6);
  // Force control at rest: f_e = f_d.
  const std::size_t before_fault = 15999;
  EXPECT_NEAR(contacts.at(before_fault).force()[2], 3.0, kRelative * 3.0);
  // Its command at step 16000 is not a number: the joints keep their torque, then impedance control has the arm again.
  EXPECT_EQ(states.at(before_fault + 2).applied_effort(), states.at(before_fault + 1).applied_effort());
  EXPECT_STREQ(states.at(before_fault + 1).holder().c_str(), "force");
  EXPECT_STREQ(states.at(before_fault + 2).holder().c_str(), "impedance");
  EXPECT_NEAR(contacts.back().force()[2], force, kRelative * force);
}

}  // namespace
}  // namespace baton::test
