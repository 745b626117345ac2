// Controllers that are started and stopped while the run goes on.
#include <gtest/gtest.h>
#include <signal.h>

#include "mcap/reader.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

nlohmann::json viewOf(const Bench& bench, const std::string& name) {
  for (const auto& one : bench.batonJson({"controllers", "--json"})) {
    if (one.at("name") == name) return one;
  }
  return nullptr;
}

bool says(const nlohmann::json& reply, const std::string& what) {
  return reply.at("reason").get<std::string>().find(what) != std::string::npos;
}

TEST(Launch, ANewControllerJoinsTakesTheBatonAndLeaves) {
  const Bench bench;
  const LiveRun run(bench, endlessContact("rate: 1\n"));
  const nlohmann::json started =
      bench.batonJson({"controller", "start", "stiff", "--law", "joint_pd", "--set", "kp=[300, 300, 300]", "--json"});
  ASSERT_TRUE(started.at("done")) << started;
  EXPECT_EQ(viewOf(bench, "stiff").at("law"), "joint_pd");
  const Finished parameters = bench.baton({"param", "list", "stiff"});
  EXPECT_NE(parameters.out.find("300"), std::string::npos) << parameters.out << parameters.err;

  EXPECT_TRUE(bench.batonJson({"swap", "stiff", "--force", "--json"}).at("done"));
  const nlohmann::json refused = bench.batonJson({"controller", "stop", "stiff", "--json"});
  EXPECT_FALSE(refused.at("accepted"));
  EXPECT_TRUE(says(refused, "holds the baton")) << refused;
  EXPECT_TRUE(bench.batonJson({"swap", "tracking", "--force", "--json"}).at("done"));
  EXPECT_TRUE(bench.batonJson({"controller", "stop", "stiff", "--json"}).at("done"));
  EXPECT_EQ(viewOf(bench, "stiff").at("state"), "failed");
  EXPECT_FALSE(bench.batonJson({"swap", "stiff", "--json"}).at("done"));

  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_TRUE(result.at("recording").at("complete")) << "who was stopped in order vouches for what it sent: " << result;
  const Finished again = bench.baton({"rerun", run.recording});
  EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
}

TEST(Launch, AnotherLawOrAnotherProgramReplacesOneThatStandsBy) {
  const Bench bench;
  const LiveRun run(bench, endlessContact("rate: 1\n"));
  // The same again, as after a new build.
  ASSERT_TRUE(bench.batonJson({"controller", "stop", "pd", "--json"}).at("done"));
  const nlohmann::json again = bench.batonJson({"controller", "start", "pd", "--json"});
  ASSERT_TRUE(again.at("done")) << again;
  EXPECT_NE(again.at("pid"), run.pidOf("pd"));
  // Another law under the old name.
  ASSERT_TRUE(bench.batonJson({"controller", "stop", "pd", "--json"}).at("done"));
  ASSERT_TRUE(bench.batonJson({"controller", "start", "pd", "--law", "joint_inverse_dynamics", "--json"}).at("done"));
  EXPECT_EQ(viewOf(bench, "pd").at("law"), "joint_inverse_dynamics");
  EXPECT_TRUE(bench.batonJson({"swap", "pd", "--force", "--json"}).at("done"));
  EXPECT_EQ(bench.batonJson({"status", "--json"}).at("holder"), "pd");
  EXPECT_TRUE(bench.batonJson({"down", "--json"}).at("recording").at("complete"));
  const Finished repeated = bench.baton({"rerun", run.recording});
  EXPECT_EQ(repeated.exit_code, 0) << repeated.out << repeated.err;
}

TEST(Launch, WhoHasBeenAskedUnderAnotherLawCannotBeRepeated) {
  const Bench bench;
  // At rest where it touches nothing: no place for a force law, but one for what comes under its name.
  const LiveRun run(bench, restingContact("rate: 1\n"));
  EXPECT_FALSE(bench.batonJson({"swap", "force", "--json"}).at("done"));
  ASSERT_TRUE(bench.batonJson({"controller", "stop", "force", "--json"}).at("done"));
  ASSERT_TRUE(bench.batonJson({"controller", "start", "force", "--law", "impedance", "--json"}).at("done"));
  EXPECT_TRUE(bench.batonJson({"swap", "force", "--force", "--json"}).at("done"));
  std::ignore = bench.batonJson({"down", "--json"});
  const Finished again = bench.baton({"rerun", run.recording});
  EXPECT_EQ(again.exit_code, 2) << again.out << again.err;
  EXPECT_NE(again.err.find("asked to take it"), std::string::npos) << again.err;
}

TEST(Launch, WhatCannotBeIsRefusedWithTheReasonAndTheRunGoesOn) {
  const Bench bench;
  const LiveRun run(bench, endlessContact("rate: 1\n"));
  const auto refused = [&](std::vector<std::string> arguments, const std::string& reason) {
    arguments.insert(arguments.begin(), "controller");
    arguments.emplace_back("--json");
    const nlohmann::json reply = bench.batonJson(arguments);
    EXPECT_FALSE(reply.at("accepted")) << reply;
    EXPECT_TRUE(says(reply, reason)) << reply;
  };
  refused({"start", "pd"}, "runs already");
  refused({"start", "fresh"}, "needs a law");
  refused({"start", "fresh", "--law", "joint_pdd"}, "joint_pd");
  refused({"start", "fresh", "--law", "joint_pd", "--set", "kp=-1"}, "kp");
  refused({"start", "fresh", "--law", "joint_pd", "--set", "kq=1"}, "kq");
  refused({"start", "plant", "--law", "joint_pd"}, "plant");
  refused({"start", "\"", "--law", "joint_pd"}, "a name of 1 to 31");
  refused({"start", "x, parameters: {kp: 3}", "--law", "joint_pd"}, "a name of 1 to 31");
  refused({"start", "fresh", "--law", "joint_pd", "--set", "kp.x.y=1"}, "kp");
  refused({"stop", "trajectory"}, "no controller");
  refused({"stop", "nobody"}, "nobody");
  EXPECT_EQ(bench.batonJson({"status", "--json"}).at("state"), "running");
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(Launch, ANewcomerThatDiesHarmsNobody) {
  const Bench bench;
  const LiveRun run(bench, endlessContact("rate: 1\n"));
  const nlohmann::json reply = bench.batonJson({"controller", "start", "fresh", "--law", "joint_pd", "--json"});
  ASSERT_TRUE(reply.at("accepted")) << reply;
  ASSERT_EQ(kill(reply.at("pid").get<int>(), SIGKILL), 0);
  EXPECT_TRUE(eventually([&] { return viewOf(bench, "fresh").at("state") == "failed"; }));
  const std::uint64_t step = bench.batonJson({"status", "--json"}).at("step");
  run.waitForStep(step + 100);
  EXPECT_EQ(bench.batonJson({"status", "--json"}).at("holder"), "tracking");
}

TEST(Launch, ANewcomerThatNeverSpeaksHarmsNobody) {
  const Bench bench;
  const std::filesystem::path programs = programsBut(bench, "baton-controller",
                                                     "case \" $* \" in *\" fresh \"*) exit 1 ;; esac; exec '" +
                                                         (programFolder() / "baton-controller").string() + "' \"$@\"");
  const auto baton = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(bench.domain())});
    return runProgram(programs / "baton", arguments, bench.folder());
  };
  const Finished up = baton({"up", bench.write("run.yaml", endlessContact("rate: 1\n")), "--no-recording"});
  ASSERT_EQ(up.exit_code, 0) << up.out << up.err;
  EXPECT_EQ(baton({"controller", "start", "fresh", "--law", "joint_pd"}).exit_code, 1);
  EXPECT_EQ(bench.batonJson({"status", "--json"}).at("state"), "running");
  EXPECT_EQ(baton({"down"}).exit_code, 0);
}

}  // namespace
}  // namespace baton::test
