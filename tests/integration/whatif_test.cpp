// `baton whatif` on recordings of real runs.
#include <gtest/gtest.h>

#include <filesystem>

#include "mcap/reader.hpp"
#include "runtime/scenario_edit.hpp"
#include "support/processes.hpp"
#include "support/reproduced.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

std::string recorded(const Bench& bench, const std::string& scenario) {
  std::string file = (bench.folder() / "run.mcap").string();
  const nlohmann::json result =
      bench.batonJson({"run", bench.write("scenario.yaml", scenario), "--out", file, "--json"});
  EXPECT_EQ(result.at("state"), "finished") << result;
  return file;
}

TEST(WhatIf, ReproducesEveryHolderWithItsChangesAndHandovers) {
  const Bench bench;
  // Handovers with help, without, and back; values that change while they hold and while they stand by; and laws that
  // integrate, learn and filter.
  const std::string file = recorded(
      bench,
      editScenario(
          shortContact(),
          {{"controllers",
            "[{name: tracking, law: operational_inverse_dynamics}, {name: yielding, law: admittance},"
            " {name: force, law: force_pi}, {name: learning, law: adaptive,"
            " parameters: {lambda: 10, kd: [10, 10, 4], k: 0.1}}]"},
           {"step_s", "0.00025"},
           {"baton", "{blend_s: 0.02}"},
           {"swaps",
            "[{at_s: 0.05, to: learning, force: true}, {at_s: 0.1, to: yielding, force: true},"
            " {at_s: 0.35, to: force, force: true}, {at_s: 0.42, to: learning, hard: true, force: true},"
            " {at_s: 0.46, to: tracking, force: true}]"},
           {"changes",
            "[{at_s: 0.07, controller: learning, set: {lambda: 12}}, {at_s: 0.15, controller: force, set: {ki: 3}},"
            " {at_s: 0.38, controller: force, set: {kd: 40}}]"}}));
  EXPECT_EQ(expectReproduced(bench, file), 4);
}

TEST(WhatIf, ReproducesABranchAndWhoStandsByCold) {
  const Bench bench;
  const std::string file = recorded(bench, shortContact("recording: {checkpoint_s: 0.1}\nstandby: cold\n"));
  EXPECT_EQ(expectReproduced(bench, file), 3);
  // In the middle of the force law's reign, whose integral is in the checkpoint alone.
  const std::string branch = (bench.folder() / "branch.mcap").string();
  ASSERT_EQ(bench.baton({"branch", file, "--at", "800", "--out", branch}).exit_code, 0);
  EXPECT_EQ(expectReproduced(bench, branch), 1);
}

TEST(WhatIf, ReproducesARealtimeRun) {
  const Bench bench;
  std::string text = shortContact("mode: realtime\nrate: 1\n");
  expectReproduced(bench, recorded(bench, text));
}

TEST(WhatIf, WritesADrawingAndCommandsThatOtherToolsRead) {
  const Bench bench;
  const std::string file = recorded(bench, shortContact()), out = (bench.folder() / "whatif").string();
  const Finished text = bench.baton({"whatif", file, "--law", "joint_pd", "--set", "kp=40", "--out", out});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_NE(text.out.find("steps 300 to 699, held by impedance"), std::string::npos) << text.out;
  const fs::path stem = fs::path(out) / "short_whatif_joint_pd";
  for (const char* extension : {".svg", ".png", ".mcap"}) EXPECT_TRUE(fs::exists(stem.string() + extension));
  const nlohmann::json made = bench.batonJson({"whatif", file, "--law", "joint_pd", "--set", "kp=40", "--json"});
  EXPECT_FALSE(made.at("exact"));
  EXPECT_EQ(made.at("tenures").size(), 3U);
  EXPECT_GE(made.at("difference").at("steps"), kShortSteps);

  const Finished reader = runProgram(
      "/bin/sh", {"-c", "node '" BATON_TEST_INTEROP "/read_mcap.mjs' '" + stem.string() + ".mcap'"}, bench.folder());
  ASSERT_EQ(reader.exit_code, 0) << reader.out << reader.err;
  const nlohmann::json summary = nlohmann::json::parse(reader.out);
  EXPECT_EQ(summary.at("topics").at("whatif_command").at("type"), "baton::msg::JointCommand");
  EXPECT_GE(summary.at("decoded"), kShortSteps);

  // A file that was cut off is read as far as it goes, and says so.
  fs::resize_file(file, fs::file_size(file) / 2);
  const nlohmann::json cut = bench.batonJson({"whatif", file, "--as", "tracking", "--json"});
  EXPECT_NE(cut.at("cut"), "");
  EXPECT_LT(cut.at("steps"), kShortSteps);
  EXPECT_TRUE(cut.at("exact")) << cut;
}

/// Without an environment.
constexpr const char* kFree =
    "name: free\nrobot: rpp\nstep_s: 0.0005\nsubsteps: 2\nduration_s: 0.2\n"
    "trajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}\n"
    "controllers: [{name: only, law: joint_inverse_dynamics}]\nactive: only\n";

TEST(WhatIf, SaysWhatItNeeds) {
  const Bench bench;
  const std::string file = recorded(bench, kFree);
  const auto exitCode = [&](std::vector<std::string> arguments, const std::string& word) {
    arguments.insert(arguments.begin(), "whatif");
    const Finished finished = bench.baton(arguments);
    EXPECT_NE(finished.err.find(word), std::string::npos) << finished.err;
    return finished.exit_code;
  };
  EXPECT_EQ(exitCode({file, "--law", "force_pi"}, "contact forces"), 2);
  EXPECT_EQ(exitCode({file}, "--law"), 2);
  EXPECT_EQ(exitCode({file, "--as", "nobody"}, "nobody"), 2);
  EXPECT_EQ(exitCode({(bench.folder() / "none.mcap").string(), "--law", "joint_pd"}, "none.mcap"), 3);
  // The only controller, by its law: the same as in its place.
  EXPECT_TRUE(bench.batonJson({"whatif", file, "--law", "joint_inverse_dynamics", "--json"}).at("exact").get<bool>());
}

TEST(WhatIf, AndTheHashOfARunNameTheTopicThatARecordingIsWithout) {
  const Bench bench;
  const auto refusal = [&](const std::vector<std::string>& arguments) {
    const Finished finished = bench.baton(arguments);
    EXPECT_EQ(finished.exit_code, 2) << finished.out << finished.err;
    return finished.err;
  };
  const std::string without = ", found a recording without it";
  const std::string no_states = recorded(bench, shortContact("recording: {except: [plant_state]}\n"));
  using Words = std::vector<std::string>;
  for (const Words& arguments : {Words{"bag", "hash", no_states}, Words{"whatif", no_states, "--law", "joint_pd"},
                                 Words{"whatif", no_states, "--as", "tracking"}, Words{"rerun", no_states}}) {
    EXPECT_NE(refusal(arguments).find("expected the topic plant_state" + without), std::string::npos) << arguments[0];
  }
  fs::remove(no_states);
  const std::string no_contact = recorded(bench, shortContact("recording: {except: [contact, swap_plan]}\n"));
  EXPECT_NE(refusal({"bag", "hash", no_contact}).find("the topic contact" + without), std::string::npos);
  EXPECT_NE(refusal({"whatif", no_contact, "--as", "tracking"}).find("the topic swap_plan" + without),
            std::string::npos);
  fs::remove(no_contact);
  // A copy that took only some topics.
  const std::string file = recorded(bench, shortContact()), cut = (bench.folder() / "cut.mcap").string();
  ASSERT_EQ(bench.baton({"bag", "cut", file, cut, "--topics", "plant_state,contact,reference"}).exit_code, 0);
  EXPECT_NE(refusal({"bag", "hash", cut}).find("the topic joint_command" + without), std::string::npos);
  const Finished alone = bench.baton({"whatif", cut, "--law", "joint_pd"});
  EXPECT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_NE(alone.out.find("the recording is without the topic joint_command"), std::string::npos) << alone.out;
  fs::remove(file);
  fs::remove(cut);
  // What a run had nothing to say on is not missed in such a copy: no contact, no reset, no decision.
  const std::string free_run = recorded(bench, kFree);
  ASSERT_EQ(bench.baton({"bag", "cut", free_run, cut, "--topics", "plant_state,reference,joint_command"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "hash", free_run, cut}).exit_code, 0);
  const Finished rerun = bench.baton({"rerun", cut});
  EXPECT_EQ(rerun.exit_code, 0) << rerun.out << rerun.err;
}

}  // namespace
}  // namespace baton::test
