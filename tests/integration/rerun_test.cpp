// Runs that operators and failures had a hand in, done again from their recordings: the same bytes.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>

#include "mcap/writer.hpp"
#include "msg/decision.h"
#include "msg/loop.h"
#include "runtime/scenario_edit.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/reproduced.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

/// The short scenario without an end and without planned handovers, at a pace that leaves time to have a hand in it.
std::string endless(const std::vector<ScenarioSetting>& more = {}) {
  std::vector<ScenarioSetting> settings{
      {"duration_s", "0"}, {"swaps", "[]"}, {"rate", "1"}, {"recording", "{checkpoint_s: 0.1}"}};
  settings.insert(settings.end(), more.begin(), more.end());
  return editScenario(shortContact(), settings);
}

std::vector<msg::Decision> decisionsOf(const std::string& recording) {
  return decodeStream<msg::Decision>(readStreams(recording)[{"decision", "plant"}]);
}

/// Who held the baton, by step.
std::vector<std::string> holdersOf(const std::string& recording) {
  std::vector<std::string> holders;
  for (const auto& state : decodeStream<msg::PlantState>(readStreams(recording)[{"plant_state", "plant"}])) {
    holders.emplace_back(state.holder().c_str());
  }
  return holders;
}

/// Does it again, and expects the same bytes; and the same torques of each controller by itself.
nlohmann::json expectIdentical(const Bench& bench, const std::string& recording) {
  nlohmann::json verdict = bench.batonJson({"rerun", recording, "--json"});
  EXPECT_TRUE(verdict.at("identical")) << verdict;
  EXPECT_EQ(verdict.at("steps_compared"), verdict.at("steps"));
  expectReproduced(bench, recording);
  return verdict;
}

TEST(Rerun, RepeatsWhatOperatorsAskedFor) {
  const Bench bench;
  const LiveRun run(bench, endless());
  run.waitForStep(100);
  EXPECT_TRUE(bench.batonJson({"swap", "impedance", "--json"}).at("done"));
  EXPECT_TRUE(bench.batonJson({"swap", "pd", "--force", "--json"}).at("done"));
  EXPECT_FALSE(bench.batonJson({"swap", "pd", "--json"}).at("done"));  // leaves no trace
  // One that is under way for the very step at which the run is then asked to end.
  const std::uint64_t step = bench.batonJson({"sim", "pause", "--json"}).at("step");
  EXPECT_EQ(bench.baton({"swap", "tracking"}).exit_code, 3) << "nothing comes of it before the run goes on";
  const nlohmann::json other = bench.batonJson({"swap", "impedance", "--json"});
  EXPECT_NE(other.at("reason").get<std::string>().find("under way"), std::string::npos) << other;
  const std::uint64_t end = step + 6;
  EXPECT_TRUE(bench.batonJson({"sim", "stop", "--at", std::to_string(end), "--json"}).at("accepted"));
  EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  const nlohmann::json result = run.result();
  EXPECT_EQ(result.at("steps"), end);
  EXPECT_EQ(holdersOf(run.recording).back(), "pd");

  const std::vector<msg::Decision> decisions = decisionsOf(run.recording);
  ASSERT_EQ(decisions.size(), 4U);
  EXPECT_EQ(decisions[0].cause(), msg::DECISION_SWAP);
  EXPECT_STREQ(decisions[0].controller().c_str(), "impedance");
  EXPECT_EQ(decisions[0].at_step(), decisions[0].step() + 6);
  EXPECT_TRUE(decisions[1].force());
  EXPECT_EQ(decisions[2].at_step(), end);
  EXPECT_EQ(decisions[3].cause(), msg::DECISION_END);
  const nlohmann::json verdict = expectIdentical(bench, run.recording);
  EXPECT_EQ(verdict.at("decisions"), 4);
  EXPECT_EQ(verdict.at("hash"), result.at("chain_hash"));
}

TEST(Rerun, RepeatsTheLastTakeOfARunThatWasReset) {
  const Bench bench;
  const LiveRun run(bench, endless());
  run.waitForStep(100);
  EXPECT_TRUE(bench.batonJson({"swap", "impedance", "--json"}).at("done"));
  EXPECT_TRUE(bench.batonJson({"sim", "reset", "--json"}).at("accepted"));
  run.waitForStep(50);
  // While the arm is on its way, pd is further from the holder than a handover may step: when this comes is up to the
  // machine.
  const nlohmann::json swapped = bench.batonJson({"swap", "pd", "--force", "--json"});
  EXPECT_TRUE(swapped.at("done")) << swapped;
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  const nlohmann::json verdict = expectIdentical(bench, run.recording);
  EXPECT_EQ(verdict.at("decisions"), 2) << "the handover of this take, and its end";
  EXPECT_EQ(verdict.at("hash"), result.at("chain_hash"));
}

TEST(Rerun, RepeatsAFailoverAndTheReturnOfANewProcess) {
  const Bench bench;
  // An adaptive law: what it learnt is gone with its process, and the bytes tell.
  const std::string scenario = endless({{"step_s", "0.00025"},
                                        {"controllers.3.law", "adaptive"},
                                        {"controllers.3.parameters", "{lambda: 10, kd: [10, 10, 4], k: 0.1}"},
                                        {"active", "pd"},
                                        {"baton", "{fallback: [impedance]}"}});
  const LiveRun run(bench, scenario, {"--restarts", "1"});
  run.waitForStep(200);
  const int before = run.pidOf("pd");
  ASSERT_EQ(kill(before, SIGKILL), 0);
  run.waitForSuccessor("pd", before);
  EXPECT_TRUE(eventually([&] { return bench.batonJson({"swap", "pd", "--json"}).at("done") == true; }));
  const std::uint64_t step = bench.batonJson({"status", "--json"}).at("step");
  run.waitForStep(step + 200);
  std::ignore = bench.batonJson({"down", "--json"});

  bool has_failed = false, has_returned = false;
  for (const msg::Decision& decision : decisionsOf(run.recording)) {
    has_failed = has_failed || (decision.cause() == msg::DECISION_FAILED && decision.controller() == "pd");
    has_returned = has_returned || (decision.cause() == msg::DECISION_RETURNED && decision.restarted());
  }
  EXPECT_TRUE(has_failed && has_returned);
  expectIdentical(bench, run.recording);
}

TEST(Rerun, ANewProcessKnowsNothingOfWhatWasChangedForTheOneBefore) {
  const Bench bench;
  const LiveRun run(bench, endless(), {"--restarts", "1"});
  run.waitForStep(100);
  // One change in force, and one that waits and never comes.
  ASSERT_EQ(bench.baton({"param", "set", "pd", "kp=30"}).exit_code, 0);
  const std::uint64_t later = bench.batonJson({"sim", "pause", "--json"}).at("step").get<std::uint64_t>() + 2000;
  ASSERT_EQ(bench.baton({"param", "set", "pd", "kd=90", "--at", std::to_string(later)}).exit_code, 0);
  const int before = run.pidOf("pd");
  ASSERT_EQ(kill(before, SIGKILL), 0);
  run.waitForSuccessor("pd", before);
  EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  EXPECT_TRUE(eventually([&] { return bench.batonJson({"swap", "pd", "--force", "--json"}).at("done") == true; }));
  EXPECT_EQ(bench.batonJson({"param", "get", "pd", "kp", "--json"}).at("kp"), std::vector<double>(3, 90.0));
  EXPECT_EQ(bench.baton({"sim", "rate", "max"}).exit_code, 0);
  run.waitForStep(later + 200);
  std::ignore = bench.batonJson({"down", "--json"});
  expectIdentical(bench, run.recording);
}

TEST(Rerun, RepeatsWhatThePlantDecidedAboutOneThatWasSilent) {
  const Bench bench;
  const LiveRun run(bench, endless({{"late", "{policy: fallback, after_s: 10}"}, {"baton", "{fallback: [pd]}"}}));
  run.waitForStep(100);
  const int pid = run.pidOf("tracking");
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  EXPECT_TRUE(eventually([&] { return bench.batonJson({"status", "--json"}).at("holder") == "pd"; }));
  ASSERT_EQ(kill(pid, SIGCONT), 0);
  // It lives and stands by, and can have the baton back.
  EXPECT_TRUE(eventually([&] { return bench.batonJson({"swap", "tracking", "--json"}).at("done") == true; }));
  std::ignore = bench.batonJson({"down", "--json"});
  const std::vector<msg::Decision> decisions = decisionsOf(run.recording);
  ASSERT_GE(decisions.size(), 3U);
  EXPECT_EQ(decisions[0].cause(), msg::DECISION_FAILED);
  EXPECT_FALSE(decisions[0].commanded());
  EXPECT_EQ(decisions[1].cause(), msg::DECISION_RETURNED);
  EXPECT_FALSE(decisions[1].restarted());
  expectIdentical(bench, run.recording);
}

TEST(Rerun, RepeatsARunWhoseWallWasLost) {
  const Bench bench;
  const LiveRun run(bench, endless());
  run.waitForStep(100);
  ASSERT_EQ(kill(run.pidOf("environment"), SIGKILL), 0);
  EXPECT_EQ(run.result().at("state"), "aborted");
  expectIdentical(bench, run.recording);
}

TEST(Rerun, PlannedFailuresHappenAtTheirSteps) {
  const Bench bench;
  const auto planned = [&](const std::string& failures) {
    return bench.write("planned.yaml", editScenario(shortContact(), {{"baton", "{fallback: [pd, impedance]}"},
                                                                     {"failures", failures}}));
  };
  const auto recorded = [&](const std::string& failures, const std::string& name) {
    const std::string file = (bench.folder() / name).string();
    nlohmann::json result = bench.batonJson({"run", planned(failures), "--out", file, "--json"});
    EXPECT_EQ(result.at("state"), "finished") << result;
    EXPECT_TRUE(result.at("recording").at("complete")) << result;
    return std::pair{file, result};
  };
  // Before the planned handover at step 300; at the first step of it, where it still commands; and never to return.
  const std::string failures =
      "[{controller: tracking, at_s: 0.05, commanded: false, returns_at_s: 0.06}, {controller: pd, at_s: 0.15},"
      " {controller: force, at_s: 0.2}]";
  const auto [file, result] = recorded(failures, "a.mcap");
  const std::vector<std::string> holders = holdersOf(file);
  ASSERT_EQ(holders.size(), kShortSteps + 1U);
  EXPECT_EQ(holders[100], "tracking") << "the step is its own still";
  EXPECT_EQ(holders[101], "pd");
  EXPECT_EQ(holders[kFirstSwap - 1], "pd") << "who returns stands by";
  EXPECT_EQ(holders[kFirstSwap], "impedance") << "who commands once more has no part in it any more";
  EXPECT_EQ(holders[kShortSteps], "impedance") << "one that is lost does not get the baton";
  EXPECT_EQ(result.at("exit_code"), 1) << "the planned handover to force was refused";
  for (const auto& swap : result.at("swaps")) {
    if (swap.at("incoming") != "force") continue;
    EXPECT_NE(swap.at("reason").get<std::string>().find("has failed"), std::string::npos);
  }

  const auto [again, same] = recorded(failures, "b.mcap");
  EXPECT_EQ(same.at("chain_hash"), result.at("chain_hash"));
  // A re-run has the failures from its recording, and so has its own.
  const std::string copy = (bench.folder() / "copy.mcap").string();
  EXPECT_EQ(bench.baton({"rerun", file, "--out", copy}).exit_code, 0);
  expectIdentical(bench, copy);
  // One command more or less is another run.
  const auto [other, different] = recorded(
      "[{controller: tracking, at_s: 0.05, returns_at_s: 0.06}, {controller: pd, at_s: 0.15},"
      " {controller: force, at_s: 0.2}]",
      "c.mcap");
  EXPECT_NE(different.at("chain_hash"), result.at("chain_hash"));
  expectIdentical(bench, other);
}

TEST(Rerun, WhoHasFailedBeforeTheFirstStepNeverHoldsIt) {
  const Bench bench;
  const std::string file = (bench.folder() / "absent.mcap").string();
  const std::string scenario = bench.write(
      "absent.yaml", editScenario(shortContact(), {{"baton", "{fallback: [pd]}"},
                                                   {"swaps", "[{at_s: 0.2, to: tracking, expect: any}]"},
                                                   {"failures", "[{controller: tracking, returns_at_s: 0.1}]"}}));
  std::ignore = bench.batonJson({"run", scenario, "--out", file, "--json"});
  const std::vector<std::string> holders = holdersOf(file);
  ASSERT_EQ(holders.size(), kShortSteps + 1U);
  EXPECT_EQ(holders[0], "pd");
  EXPECT_EQ(holders[399], "pd");
  EXPECT_EQ(holders[400], "tracking");
  expectIdentical(bench, file);
}

TEST(Rerun, ABranchRepeatsWhatWasDecidedBeforeIt) {
  const Bench bench;
  const LiveRun run(bench, endless({{"duration_s", "1"}, {"baton", "{fallback: [pd]}"}}), {"--paused"});
  ASSERT_EQ(bench.baton({"sim", "step", "120"}).exit_code, 0);
  ASSERT_EQ(kill(run.pidOf("tracking"), SIGKILL), 0);
  EXPECT_TRUE(eventually([&] {
    return bench.baton({"sim", "step", "1"}).exit_code == 0 &&
           bench.batonJson({"status", "--json"}).at("holder") == "pd";
  }));
  ASSERT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  const nlohmann::json result = run.result();
  ASSERT_EQ(result.at("state"), "finished") << result;
  // Not at a checkpoint: the steps since the last one, and the failover, are repeated.
  const nlohmann::json branched = bench.batonJson({"branch", run.recording, "--at", "190", "--json"});
  EXPECT_EQ(branched.at("state"), "finished") << branched;
  EXPECT_EQ(branched.at("chain_hash"), result.at("chain_hash"));
  // And what a branch did is done again from its own recording.
  const std::string file = branched.at("recording").at("path");
  expectIdentical(bench, file);
}

/// The recording with one text of its scenario replaced, and with other values of what it was made with.
void forge(const std::string& from, const std::string& to, const std::string& what, const std::string& with,
           const mcap::StringMap& made_with = {}) {
  std::filesystem::remove(to);
  const mcap::Reader reader(from);
  mcap::Writer writer(to, {});
  for (const mcap::AttachmentIndex& index : reader.attachments()) {
    mcap::Bytes data = reader.readAttachment(index);
    std::string text(reinterpret_cast<const char*>(data.data()), data.size());
    if (const std::size_t at = text.find(what); index.name == "scenario.yaml" && at != std::string::npos) {
      text.replace(at, what.size(), with);
    }
    writer.addAttachment(index.name, "application/yaml", 0, 0, std::as_bytes(std::span(text)));
  }
  for (const mcap::Metadata& one : reader.metadata()) {
    if (one.name != "baton.run") continue;
    mcap::StringMap values = one.values;
    for (const auto& [key, value] : made_with) values[key] = value;
    writer.addMetadata(one.name, values);
  }
  std::map<mcap::ChannelId, mcap::ChannelId> channels;
  reader.forEachMessage({.order = mcap::MessageFilter::Order::kFile}, [&](const mcap::MessageView& view) {
    const auto [channel, is_new] = channels.try_emplace(view.channel->id);
    if (is_new) {
      channel->second =
          writer.addChannel(view.channel->topic, "cdr",
                            writer.addSchema(view.schema->name, "omgidl", view.schema->data), view.channel->metadata);
    }
    writer.write(channel->second, view.sequence, view.log_time_ns, view.publish_time_ns, view.data);
  });
  writer.close();
}

TEST(Rerun, NamesTheFirstStepAndTopicThatDiffer) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string(), forged = (bench.folder() / "forged.mcap").string();
  ASSERT_EQ(bench.baton({"run", bench.write("short.yaml", shortContact()), "--out", file}).exit_code, 0);
  forge(file, forged, "{name: impedance, law: impedance}", "{name: impedance, law: impedance, parameters: {kp: 150}}");
  const nlohmann::json verdict = bench.batonJson({"rerun", forged, "--json"});
  EXPECT_FALSE(verdict.at("identical"));
  EXPECT_EQ(verdict.at("first_different_step"), kFirstSwap) << verdict;
  EXPECT_EQ(verdict.at("topic"), "joint_command");
  EXPECT_EQ(verdict.at("made_with"), nlohmann::json::object()) << "the same programs on the same machine";
  EXPECT_EQ(bench.baton({"rerun", forged}).exit_code, 1);
  forge(file, forged, "stiffness_N_per_m: 200", "stiffness_N_per_m: 201");
  EXPECT_EQ(bench.batonJson({"rerun", forged, "--json"}).at("topic"), "contact");
  forge(file, forged, "duration_s: 0.5", "duration_s: 0.4");
  const nlohmann::json shorter = bench.batonJson({"rerun", forged, "--json"});
  EXPECT_EQ(shorter.at("first_different_step"), 800) << "its end, where all parts save their state";
  EXPECT_EQ(shorter.at("steps_compared"), 801);
}

TEST(Rerun, NamesFirstWhatTheRecordingWasMadeWithWhereItDiffers) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string(), forged = (bench.folder() / "forged.mcap").string();
  ASSERT_EQ(bench.baton({"run", bench.write("short.yaml", shortContact()), "--out", file}).exit_code, 0);
  const std::string wall = "stiffness_N_per_m: 200";
  forge(file, forged, wall, wall, {{"mathematics", "SLEEF 2.0.0"}});
  EXPECT_EQ(bench.baton({"rerun", forged}).exit_code, 0) << "equal bytes are equal, whatever made them";
  forge(file, forged, wall, "stiffness_N_per_m: 201", {{"mathematics", "SLEEF 2.0.0"}});
  const nlohmann::json made_with = bench.batonJson({"rerun", forged, "--json"}).at("made_with");
  ASSERT_EQ(made_with.size(), 1U) << made_with;
  EXPECT_EQ(made_with.at("mathematics").at("recording"), "SLEEF 2.0.0");
  const std::string said = bench.baton({"rerun", forged}).out;
  EXPECT_EQ(said.rfind("differs: mathematics: SLEEF 2.0.0 in the recording, SLEEF ", 0), 0U) << said;
  EXPECT_NE(said.find("; first at step"), std::string::npos) << said;
}

TEST(Rerun, WhosePlantDiesBeforeTheFirstStepDiffersAndTheRecordingIsNotBlamed) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string();
  ASSERT_EQ(bench.baton({"run", bench.write("short.yaml", shortContact()), "--out", file}).exit_code, 0);
  const Finished again = runProgram(programsBut(bench, "baton-plant", "kill -KILL $$") / "baton",
                                    {"rerun", file, "--domain", std::to_string(bench.domain())}, bench.folder());
  EXPECT_EQ(again.exit_code, 1) << again.out << again.err;
  const std::string said = again.out + again.err;
  EXPECT_NE(said.find("plant could not start"), std::string::npos) << said;
  EXPECT_EQ(said.find("expected the recording of a run"), std::string::npos) << said;
  EXPECT_EQ(said.find("\nrecording "), std::string::npos) << "there is none: " << said;
  EXPECT_TRUE(std::filesystem::is_empty(bench.folder() / "reruns")) << "nothing was made, and nothing is left";
}

TEST(Rerun, RefusesWhatCannotBeRepeated) {
  const Bench bench;
  const std::string file = (bench.folder() / "realtime.mcap").string();
  const std::string scenario =
      bench.write("realtime.yaml", editScenario(shortContact(), {{"mode", "realtime"}, {"rate", "1"}}));
  std::ignore = bench.baton({"run", scenario, "--out", file});
  const Finished refused = bench.baton({"rerun", file});
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_NE(refused.err.find("realtime"), std::string::npos) << refused.err;
  EXPECT_TRUE(std::filesystem::is_empty(bench.folder() / "reruns")) << "nothing was made, and nothing is left";
  EXPECT_EQ(bench.baton({"rerun", (bench.folder() / "none.mcap").string()}).exit_code, 3);
}

}  // namespace
}  // namespace baton::test
