// Parameters changed while a run of real processes goes on: exact, repeatable, refused when wrong.
#include <gtest/gtest.h>

#include <algorithm>

#include "msg/decision.h"
#include "msg/loop.h"
#include "support/live_run.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

TEST(Param, AGainBeyondAllMeasureCostsTheHolderTheBatonAndNotTheRun) {
  const Bench bench;
  std::string text = endlessContact("baton: {fallback: [tracking]}\n");  // and no max_command
  const std::string active = "active: tracking";
  text.replace(text.find(active), active.size(), "active: pd");
  const LiveRun run(bench, text);
  ASSERT_EQ(bench.baton({"param", "set", "pd", "kp=1e308"}).exit_code, 0);
  EXPECT_TRUE(eventually([&] { return bench.batonJson({"status", "--json"}).at("holder") == "tracking"; }));
  const std::uint64_t then = bench.batonJson({"status", "--json"}).at("step");
  run.waitForStep(then + 100);
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_EQ(result.at("state"), "stopped") << result;
  ASSERT_FALSE(result.at("swaps").empty()) << result;
  const std::string reason = result.at("swaps").at(0).at("reason");
  const auto says = [&](const char* words) { return reason.find(words) != std::string::npos; };
  EXPECT_TRUE(says("max_command") || says("not finite") || says("beyond 1e12")) << reason;
}

const std::string kCheckpoints = "recording: {checkpoint_s: 0.1}\n";

/// The short scenario, waiting before its first step.
struct PausedRun {
  explicit PausedRun(const std::string& extra = kCheckpoints) : live(bench, shortContact(extra), {"--paused"}) {}

  [[nodiscard]] nlohmann::json set(std::vector<std::string> arguments, int exit_code = 0) const {
    arguments.insert(arguments.begin(), {"param", "set"});
    arguments.emplace_back("--json");
    const Finished finished = bench.baton(arguments);
    EXPECT_EQ(finished.exit_code, exit_code) << finished.out << finished.err;
    return finished.out.empty() ? nlohmann::json{{"reason", finished.err}} : nlohmann::json::parse(finished.out);
  }
  [[nodiscard]] nlohmann::json get(const std::string& controller, const std::string& name) const {
    return bench.batonJson({"param", "get", controller, name, "--json"}).at(name);
  }
  [[nodiscard]] nlohmann::json finish() const {
    EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
    return live.result();
  }
  /// The same scenario with more keys, from its start to its end.
  [[nodiscard]] nlohmann::json planned(const std::string& extra, const std::string& out = "") const {
    std::vector<std::string> arguments{"run", bench.write("planned.yaml", shortContact(extra)), "--json"};
    if (!out.empty()) arguments.insert(arguments.end(), {"--out", out});
    return bench.batonJson(arguments);
  }

  const Bench bench;
  const LiveRun live;
};

TEST(Param, AChangeHasTheBytesOfOneThatWasPlanned) {
  const PausedRun run;
  // The holder in contact, one that stands by and holds later, one that never does.
  EXPECT_EQ(run.set({"impedance", "kp=300", "kd=[40, 40, 30, 20, 20, 20]", "--at", "650"}).at("at_step"), 650);
  EXPECT_EQ(run.set({"force", "ki=0.4", "--at-time", "0.1"}).at("at_step"), 200);
  EXPECT_EQ(run.set({"pd", "kp=10*pi", "--at", "300"}).at("at_step"), 300);
  const nlohmann::json result = run.finish();
  ASSERT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_TRUE(result.at("recording").at("complete")) << result;

  const std::string file = (run.bench.folder() / "planned.mcap").string();
  const std::string changes =
      "changes:\n"
      "  - {at_s: 0.325, controller: impedance, set: {kp: 300, kd: [40, 40, 30, 20, 20, 20]}}\n"
      "  - {at_s: 0.1, controller: force, set: {ki: 0.4}}\n"
      "  - {at_s: 0.15, controller: pd, set: {kp: 10*pi}}\n";
  const nlohmann::json planned = run.planned(kCheckpoints + changes, file);
  EXPECT_EQ(planned.at("chain_hash"), result.at("chain_hash"));
  EXPECT_NE(run.planned("").at("chain_hash"), result.at("chain_hash"));
  Streams asked_streams = loopStreams(run.live.recording);
  EXPECT_EQ(asked_streams, loopStreams(file));

  // The impedance law held the baton, and the tip touched.
  const auto states = decodeStream<msg::PlantState>(asked_streams[{"plant_state", "plant"}]);
  EXPECT_STREQ(states.at(650).holder().c_str(), "impedance");
  const auto contacts = decodeStream<msg::Contact>(asked_streams[{"contact", "environment"}]);
  EXPECT_GT(contacts.at(650).force()[2], 0.0);

  // The recording alone says what was changed; a branch from behind a change goes on with it, and one from before has
  // it still to come. 750 lies between two checkpoints.
  EXPECT_EQ(run.bench.baton({"rerun", run.live.recording}).exit_code, 0);
  for (const char* step : {"400", "750", "800"}) {
    EXPECT_EQ(run.bench.batonJson({"branch", run.live.recording, "--at", step, "--json"}).at("chain_hash"),
              result.at("chain_hash"))
        << "from step " << step;
  }
}

TEST(Param, WhatWasDecidedIsInTheRecording) {
  const PausedRun run;
  (void)run.set({"impedance", "form=no_force", "kp=300", "--at", "400"});
  (void)run.set({"impedance", "kp=-1"}, 1);
  ASSERT_EQ(run.finish().at("exit_code"), 0);
  Streams streams = readStreams(run.live.recording);
  const auto decisions = decodeStream<msg::Decision>(streams[{"decision", "impedance"}]);
  ASSERT_EQ(decisions.size(), 1U);
  EXPECT_EQ(decisions[0].cause(), msg::DECISION_PARAMETERS);
  EXPECT_STREQ(decisions[0].controller().c_str(), "impedance");
  EXPECT_EQ(decisions[0].at_step(), 400U);
  ASSERT_EQ(decisions[0].values().size(), 2U);
  EXPECT_STREQ(decisions[0].values()[0].word().c_str(), "no_force");
  EXPECT_EQ(decisions[0].values()[1].numbers(), std::vector<double>(6, 300.0));
  const auto replies = decodeStream<msg::ParameterReply>(streams[{"parameter_reply", "impedance"}]);
  ASSERT_EQ(replies.size(), 2U);
  EXPECT_TRUE(replies[0].accepted());
  EXPECT_FALSE(replies[1].accepted());
  const bool has_requests = std::any_of(streams.begin(), streams.end(),
                                        [](const auto& one) { return one.first.first == "parameter_request"; });
  EXPECT_TRUE(has_requests);
}

TEST(Param, AsSoonAsPossibleIsTheNextStepAlsoWhilePaused) {
  const PausedRun run("");
  EXPECT_EQ(run.bench.baton({"sim", "step", "100"}).exit_code, 0);
  const std::uint64_t at_step = run.set({"tracking", "kp=200"}).at("at_step");
  EXPECT_GE(at_step, 100U);
  EXPECT_LE(at_step, 101U) << "step 100 is open, and its torque may be there or not";
  const nlohmann::json result = run.finish();
  const std::string at_s = std::to_string(static_cast<double>(at_step) * 0.0005);
  EXPECT_EQ(run.planned("changes: [{at_s: " + at_s + ", controller: tracking, set: {kp: 200}}]\n").at("chain_hash"),
            result.at("chain_hash"));
}

TEST(Param, RefusesWhatCannotBeAndChangesNothing) {
  const PausedRun run("");
  EXPECT_EQ(run.bench.baton({"sim", "step", "100"}).exit_code, 0);
  const nlohmann::json before = run.bench.batonJson({"param", "list", "--json"});
  const auto refused = [&](const std::vector<std::string>& arguments, int exit_code, const std::string& word) {
    const std::string reason = run.set(arguments, exit_code).at("reason");
    EXPECT_NE(reason.find(word), std::string::npos) << reason;
  };
  // By the controller, which knows its declaration.
  refused({"impedance", "kd=10", "kp=-1"}, 1, "expected numbers >= 0");
  refused({"impedance", "kp=[1, 2]"}, 1, "1 or 6 numbers");
  refused({"impedance", "kp=high"}, 1, "'high'");
  refused({"impedance", "form=printed"}, 1, "one of corrected, as_printed, no_force");
  refused({"impedance", "kq=1"}, 1, "kq");
  refused({"impedance", "kp=1", "kp=2"}, 1, "several");
  refused({"impedance", "kp=300", "--at", "50"}, 1, "gone by");
  refused({"impedance", "kp=300", "--at", "1000"}, 1, "before the end");
  // By the command line.
  refused({"nobody", "kp=1"}, 2, "nobody");
  refused({"impedance", "kp"}, 2, "NAME=VALUE");
  refused({"impedance", "kp=1", "--at", "0"}, 2, "--at");
  EXPECT_EQ(run.bench.batonJson({"param", "list", "--json"}), before);
  const nlohmann::json result = run.finish();
  EXPECT_EQ(result.at("chain_hash"), run.planned("").at("chain_hash"));
}

TEST(Param, AResetGoesBackToTheScenario) {
  const PausedRun run("");
  const nlohmann::json before = run.get("tracking", "kp");
  (void)run.set({"tracking", "kp=200"});
  (void)run.set({"impedance", "kp=300", "--at", "400"});
  EXPECT_EQ(run.bench.baton({"sim", "step", "100"}).exit_code, 0);
  EXPECT_EQ(run.get("tracking", "kp"), nlohmann::json(std::vector<double>(6, 200.0)));
  EXPECT_EQ(run.bench.baton({"sim", "reset"}).exit_code, 0);
  EXPECT_EQ(run.get("tracking", "kp"), before);
  const nlohmann::json result = run.finish();
  EXPECT_EQ(result.at("chain_hash"), run.planned("").at("chain_hash"));
}

TEST(Param, OneProcessHasTheSameBytes) {
  const Bench bench;
  std::string text = shortContact();
  text.erase(text.find("swaps:"));
  const std::string scenario =
      bench.write("alone.yaml", text + "changes: [{at_s: 0.2, controller: tracking, set: {kp: 200}}]\n");
  const nlohmann::json many = bench.batonJson({"run", scenario, "--json"});
  const nlohmann::json one = bench.batonJson({"run", scenario, "--in-process", "--json"});
  EXPECT_EQ(many.at("exit_code"), 0) << many;
  EXPECT_EQ(one.at("chain_hash"), many.at("chain_hash"));
}

}  // namespace
}  // namespace baton::test
