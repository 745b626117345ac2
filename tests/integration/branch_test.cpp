// Checkpoints and branches: a run can be gone on with from any step, and without a change its bytes are the same.
#include <gtest/gtest.h>

#include "msg/loop.h"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

struct Recorded {
  std::string file;
  nlohmann::json result;
};

class Branch : public ::testing::Test {
 protected:
  Branch() {
    original.file = (bench.folder() / "original.mcap").string();
    original.result =
        bench.batonJson({"run", bench.write("short.yaml", shortContact("recording: {checkpoint_s: 0.1}\n")), "--out",
                         original.file, "--json"});
  }
  Recorded branch(std::vector<std::string> arguments) const {
    Recorded made{.file = (bench.folder() / "branch.mcap").string(), .result = {}};
    arguments.insert(arguments.begin(), {"branch", original.file});
    arguments.insert(arguments.end(), {"--out", made.file, "--overwrite", "--json"});
    made.result = bench.batonJson(arguments);
    return made;
  }

  const Bench bench;
  Recorded original;
};

/// The messages from a step on.
template <class T>
std::vector<T> from(std::uint64_t step, std::vector<T> messages) {
  std::erase_if(messages, [&](const T& one) { return one.step() < step; });
  return messages;
}

TEST_F(Branch, WithoutAChangeGivesTheBytesOfTheOriginal) {
  ASSERT_EQ(original.result.at("exit_code"), 0) << original.result;
  Streams then = loopStreams(original.file);
  // 400: a checkpoint, while the torque of a handover still fades. 437: between two checkpoints.
  for (const std::uint64_t step : {400U, 437U}) {
    const Recorded made = branch({"--at", std::to_string(step)});
    EXPECT_EQ(made.result.at("exit_code"), 0) << made.result;
    EXPECT_EQ(made.result.at("first_step"), step);
    EXPECT_EQ(made.result.at("chain_hash"), original.result.at("chain_hash")) << "from step " << step;
    EXPECT_TRUE(made.result.at("recording").at("complete")) << made.result;
    Streams now = loopStreams(made.file);
    const auto expectSame = [&]<class T>(const std::string& topic, const std::string& service, T) {
      const std::vector<T> expected = from(step, decodeStream<T>(then[{topic, service}]));
      EXPECT_FALSE(expected.empty()) << topic;
      EXPECT_EQ((decodeStream<T>(now[{topic, service}])), expected) << topic << " of " << service;
    };
    expectSame("plant_state", "plant", msg::PlantState{});
    expectSame("contact", "environment", msg::Contact{});
    expectSame("reference", "trajectory", msg::Reference{});
    for (const char* name : {"impedance", "force"}) expectSame("joint_command", name, msg::JointCommand{});
    for (const char* name : {"tracking", "pd"}) expectSame("shadow_command", name, msg::JointCommand{});
    // A branch can be branched again.
    const nlohmann::json again = bench.batonJson({"branch", made.file, "--at", "800", "--json"});
    EXPECT_EQ(again.at("chain_hash"), original.result.at("chain_hash")) << again;
  }
}

TEST_F(Branch, TakesAnotherControllerOrOtherValuesFromThere) {
  const Recorded swapped = branch({"--at", "400", "--swap", "tracking"});
  EXPECT_EQ(swapped.result.at("exit_code"), 0) << swapped.result;
  EXPECT_NE(swapped.result.at("chain_hash"), original.result.at("chain_hash"));
  ASSERT_EQ(swapped.result.at("swaps").size(), 2U) << swapped.result;  // and the one the scenario has later
  EXPECT_EQ(swapped.result.at("swaps").at(0).at("incoming"), "tracking");
  EXPECT_EQ(swapped.result.at("swaps").at(0).at("at_step"), 406);
  EXPECT_EQ(swapped.result.at("swaps").at(1).at("incoming"), "force");

  const Recorded stiffer = branch({"--at", "400", "--set", "controllers.impedance.parameters.kp=300", "--set",
                                   "environment.walls.0.stiffness_N_per_m=400"});
  EXPECT_EQ(stiffer.result.at("exit_code"), 0) << stiffer.result;
  EXPECT_NE(stiffer.result.at("chain_hash"), original.result.at("chain_hash"));
  const nlohmann::json metrics = bench.batonJson({"metrics", stiffer.file, "--json"});
  EXPECT_EQ(metrics.at("steps"), kShortSteps - 400);
  EXPECT_DOUBLE_EQ(metrics.at("duration_s"), 0.3) << "of the branch, not from step 0";
}

TEST_F(Branch, RefusesWhatCannotBeGoneOnWith) {
  const auto refused = [&](std::vector<std::string> arguments, const std::string& word) {
    arguments.insert(arguments.begin(), {"branch", original.file});
    const Finished finished = bench.baton(arguments);
    EXPECT_EQ(finished.exit_code, 2) << finished.out << finished.err;
    EXPECT_NE(finished.err.find(word), std::string::npos) << finished.err;
  };
  refused({"--at", "1000"}, "a step before its last");
  refused({"--at", "298"}, "lies in the handover to impedance");
  refused({"--at", "400", "--swap", "nobody"}, "nobody");
  refused({"--at", "400", "--set", "controllers.impedance.parameters.kq=1"}, "kq");
  refused({"--at", "400", "--set", "controllers.nobody.law=joint_pd"}, "nobody");
  refused({"--at", "400", "--set", "step_s=0.001"}, "goes on with the step");
  refused({"--at", "800", "--set", "duration_s=0.3"}, "an end after");
  refused({}, "--at");
}

}  // namespace
}  // namespace baton::test
