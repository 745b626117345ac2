// Time on real processes: whoever is stopped, loses datagrams or starts late, a lockstep run has the same bytes.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>

#include "runtime/scenario_edit.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

/// The hash of the short scenario, undisturbed.
std::string undisturbedHash(const Bench& bench) {
  const nlohmann::json result =
      bench.batonJson({"run", bench.write("undisturbed.yaml", shortContact()), "--no-recording", "--json"});
  EXPECT_EQ(result.at("state"), "finished") << result;
  return result.at("chain_hash");
}

/// A variable that what is started meanwhile inherits.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Environment() { unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
};

class StoppedService : public ::testing::TestWithParam<std::string> {};

TEST_P(StoppedService, ForTwoSecondsLeavesEveryByteAsItWas) {
  const Bench bench;
  const std::string expected = undisturbedHash(bench);
  const LiveRun run(bench, shortContact(), {"--paused"});
  ASSERT_EQ(bench.baton({"sim", "step", "150"}).exit_code, 0);
  const int pid = run.pidOf(GetParam());
  ASSERT_GT(pid, 0);
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  if (GetParam() != "plant") {
    EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  }
  const auto stopped = std::chrono::steady_clock::now();
  EXPECT_TRUE(eventually([&] { return std::chrono::steady_clock::now() - stopped > std::chrono::seconds(2); }));
  ASSERT_EQ(kill(pid, SIGCONT), 0);
  if (GetParam() == "plant") {
    EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  }
  const nlohmann::json result = run.result();
  EXPECT_EQ(result.at("state"), "finished") << result;
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
  EXPECT_EQ(result.at("chain_hash"), expected);
}

INSTANTIATE_TEST_SUITE_P(Each, StoppedService,
                         ::testing::Values("plant", "environment", "trajectory", "recorder", "tracking", "force"),
                         [](const auto& service) { return service.param; });

/// Stops the holder for good at a step; the scenario's policy decides.
struct SilentHolder {
  SilentHolder(const Bench& bench, const std::string& policy, const std::string& after_s)
      : run(bench, shortContact("baton: {fallback: [pd]}\nlate: {policy: " + policy + ", after_s: " + after_s + "}\n"),
            {"--paused"}),
        pid(run.pidOf("tracking")) {
    EXPECT_EQ(bench.baton({"sim", "step", "150"}).exit_code, 0);
    EXPECT_EQ(kill(pid, SIGSTOP), 0);
    EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  }
  LiveRun run;
  int pid;
};

TEST(LatePolicy, WaitGoesOnWhereItWasHoweverLongItTook) {
  const Bench bench;
  const std::string expected = undisturbedHash(bench);
  const SilentHolder silent(bench, "wait", "0.3");
  // The plant warns later than after_s, where the other policies decide.
  EXPECT_TRUE(eventually([&] {
    return bench.baton({"logs", "plant"}).out.find("the step waits for") != std::string::npos;
  }));
  EXPECT_EQ(kill(silent.pid, SIGCONT), 0);
  const nlohmann::json result = silent.run.result();
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(result.at("chain_hash"), expected);
}

TEST(LatePolicy, FallbackGivesTheBatonToTheNext) {
  const Bench bench;
  const SilentHolder silent(bench, "fallback", "10");
  const nlohmann::json result = silent.run.result();
  EXPECT_EQ(result.at("state"), "finished") << result;
  EXPECT_EQ(result.at("exit_code"), 1) << "a controller lost the baton: " << result;
  const auto& failover = result.at("swaps").at(0);
  EXPECT_EQ(failover.at("outgoing"), "tracking");
  EXPECT_EQ(failover.at("incoming"), "pd");
  EXPECT_NE(failover.at("reason").get<std::string>().find("silent"), std::string::npos) << failover;
}

TEST(LatePolicy, AbortEndsTheRunWithTheReason) {
  const Bench bench;
  const SilentHolder silent(bench, "abort", "10");
  const nlohmann::json result = silent.run.result();
  EXPECT_EQ(result.at("exit_code"), 4) << result;
  EXPECT_EQ(result.at("state"), "aborted") << result;
  // The step it was stopped in, or the next when it had commanded that one.
  EXPECT_GE(result.at("steps"), 150) << result;
  EXPECT_LE(result.at("steps"), 151) << result;
  EXPECT_NE(result.at("reason").get<std::string>().find("waits for"), std::string::npos) << result;
}

TEST(Straggler, LostDatagramsChangeNoByteAndLeaveNoGap) {
  const Bench bench;
  const std::string expected = undisturbedHash(bench);
  const std::string scenario = bench.write("lossy.yaml", shortContact());
  {
    const Environment unreadable("BATON_LOSE_ONE_IN", "all");
    const Finished refused = bench.baton({"run", scenario});
    EXPECT_EQ(refused.exit_code, 2) << "the variable is read: " << refused.err;
  }
  const Environment lossy("BATON_LOSE_ONE_IN", "50");
  const nlohmann::json result = bench.batonJson({"run", scenario, "--json"});
  EXPECT_EQ(result.at("state"), "finished") << result;
  EXPECT_EQ(result.at("chain_hash"), expected);
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
}

TEST(Straggler, BusyCoresAndObserversChangeNoByte) {
  Bench bench;
  const std::string expected = undisturbedHash(bench);
  for (int i = 0; i < 4; ++i) (void)bench.start("/bin/sh", {"-c", "while :; do :; done"}, "busy.log");
  const LiveRun run(bench, shortContact(), {"--paused"});
  EXPECT_EQ(bench.baton({"controllers"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"sim", "step", "100"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"status"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  EXPECT_EQ(run.result().at("chain_hash"), expected);
}

TEST(Straggler, PartsStartedInAnyOrderGiveTheSameBytes) {
  Bench bench;
  const std::string scenario = bench.write("short.yaml", shortContact());
  const auto recording = [&](const std::string& name) { return (bench.folder() / (name + ".mcap")).string(); };
  ASSERT_EQ(bench.baton({"run", scenario, "--out", recording("together")}).exit_code, 0);
  const Streams expected = loopStreams(recording("together"));
  const std::vector<std::vector<std::string>> orders{
      {"plant", "force", "environment", "recorder", "pd", "trajectory", "tracking", "impedance"},
      {"tracking", "trajectory", "impedance", "pd", "environment", "plant", "force", "recorder"}};
  for (const std::vector<std::string>& order : orders) {
    const std::string run = "started-with-" + order.front();
    std::vector<int> others;
    int recorder = 0;
    for (const std::string& name : order) {
      const bool is_recorder = name == "recorder";
      const bool is_controller = !is_recorder && name != "plant" && name != "environment" && name != "trajectory";
      std::vector<std::string> arguments{"--scenario", scenario,   "--run",
                                         run,          "--domain", std::to_string(bench.domain())};
      if (is_controller) arguments.insert(arguments.end(), {"--name", name});
      if (is_recorder) arguments.insert(arguments.end(), {"--out", recording(run)});
      const int pid = bench.start("baton-" + (is_controller ? "controller" : name), arguments, run + name + ".log");
      (is_recorder ? recorder : others.emplace_back()) = pid;
    }
    EXPECT_EQ(bench.wait(recorder), 0) << "complete";
    for (const int pid : others) {
      kill(pid, SIGTERM);
      EXPECT_EQ(bench.wait(pid), 0);
    }
    EXPECT_TRUE(loopStreams(recording(run)) == expected) << run;
  }
}

TEST(Reset, GoesBackToTheFirstStepAndRepeatsTheRun) {
  const Bench bench;
  const std::string expected = undisturbedHash(bench);
  const LiveRun run(bench, shortContact(), {"--paused"});
  // While the torque of a handover fades; then, a second time, in the middle of a plan.
  for (const char* steps : {"350", "296"}) {
    ASSERT_EQ(bench.baton({"sim", "step", steps}).exit_code, 0);
    const nlohmann::json reset = bench.batonJson({"sim", "reset", "--json"});
    EXPECT_TRUE(reset.at("accepted")) << reset;
    EXPECT_EQ(reset.at("step"), 0);
    const nlohmann::json status = bench.batonJson({"status", "--json"});
    EXPECT_EQ(status.at("state"), "paused");
    EXPECT_EQ(status.at("holder"), "tracking");
  }
  ASSERT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  const nlohmann::json result = run.result();
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(result.at("chain_hash"), expected);
  EXPECT_EQ(result.at("swaps").size(), 2U) << "those of the last take";
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
  const nlohmann::json hash = bench.batonJson({"bag", "hash", run.recording, "--json"});
  EXPECT_EQ(hash.at("hash"), expected);
  EXPECT_TRUE(hash.at("payloads_agree"));
  EXPECT_EQ(bench.batonJson({"metrics", run.recording, "--json"}).at("steps"), kShortSteps);
  // What shows all of the file says that steps come twice.
  const std::vector<std::string> cat{"bag", "cat", run.recording, "--topics", "swap_report"};
  const Finished all = bench.baton(cat);
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_NE(all.err.find("the run was reset (2 times)"), std::string::npos) << all.err;
  std::vector<std::string> last = cat;
  last.insert(last.end(), {"--from-step", "0"});
  EXPECT_EQ(bench.baton(last).err, "");
}

TEST(Reset, WhileTheRunGoesOn) {
  const std::string realtime = "mode: realtime\nmax_missed_steps: 1000000\n";
  for (const std::string& mode : {std::string("rate: max\n"), realtime}) {
    const Bench bench;
    std::string scenario = restingContact(mode);  // where a busy machine's late commands move nothing
    // A reset waits for a step that has all its inputs, which a busy machine may not have within half a millisecond.
    if (mode == realtime) scenario = editScenario(scenario, {{"step_s", "0.01"}, {"substeps", "40"}});
    const LiveRun run(bench, scenario);
    run.waitForStep(100);
    const nlohmann::json reset = bench.batonJson({"sim", "reset", "--json"});
    EXPECT_TRUE(reset.at("accepted")) << reset;
    EXPECT_EQ(bench.batonJson({"status", "--json"}).at("state"), "running");
    run.waitForStep(100);
    const nlohmann::json result = bench.batonJson({"down", "--json"});
    if (mode == realtime) continue;  // which waits for no recorder
    EXPECT_TRUE(result.at("recording").at("complete")) << result;
    EXPECT_EQ(bench.baton({"bag", "hash", run.recording}).exit_code, 0);
  }
}

TEST(Requests, PauseAndStopAtTheStepAskedFor) {
  const Bench bench;
  const LiveRun run(bench, shortContact(), {"--paused"});
  EXPECT_TRUE(bench.batonJson({"sim", "pause", "--at", "400", "--json"}).at("accepted"));
  EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  EXPECT_TRUE(eventually([&] {
    const nlohmann::json now = bench.batonJson({"status", "--json"});
    return now.at("state") == "paused" && now.at("step") == 400;
  }));
  EXPECT_EQ(bench.baton({"sim", "stop", "--at", "400"}).exit_code, 1) << "it is the open step already";
  EXPECT_EQ(bench.baton({"sim", "stop", "--at", "1001"}).exit_code, 1) << "behind the end";
  EXPECT_TRUE(bench.batonJson({"sim", "stop", "--at-time", "0.3", "--json"}).at("accepted"));
  EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  const nlohmann::json result = run.result();
  EXPECT_EQ(result.at("steps"), 600);
  EXPECT_EQ(result.at("state"), "finished");
}

TEST(BagHash, NamesTheFirstStepAndTopicInWhichTwoRunsDiffer) {
  const Bench bench;
  const auto record = [&](const std::string& name, const std::string& text) {
    std::string file = (bench.folder() / (name + ".mcap")).string();
    EXPECT_EQ(bench.baton({"run", bench.write(name + ".yaml", text), "--out", file}).exit_code, 0);
    return file;
  };
  std::string softer = shortContact();
  const std::string stiffness = "stiffness_N_per_m: 200";
  softer.replace(softer.find(stiffness), stiffness.size(), "stiffness_N_per_m: 150");
  const std::string a = record("a", shortContact()), b = record("b", shortContact()), c = record("c", softer);
  EXPECT_EQ(bench.baton({"bag", "hash", a, b}).exit_code, 0);
  const Finished different = bench.baton({"bag", "hash", a, c, "--json"});
  EXPECT_EQ(different.exit_code, 1);
  const nlohmann::json parting = nlohmann::json::parse(different.out).at("same_as");
  EXPECT_FALSE(parting.at("same"));
  EXPECT_EQ(parting.at("topic"), "contact") << "the wall is what differs";
}

}  // namespace
}  // namespace baton::test
