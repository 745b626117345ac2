// Faults on real processes: whoever dies, the run ends with a word, nobody is left behind, and the recording can be
// read.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "dds/typed.hpp"
#include "mcap/reader.hpp"
#include "runtime/paths.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

namespace fs = std::filesystem;

class KilledService : public ::testing::TestWithParam<std::string> {};

TEST_P(KilledService, EndsTheRunWithAWordAndLeavesNothingBehind) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  run.waitForStep(200);
  EXPECT_TRUE(eventually([&] { return fs::file_size(run.recording) > 100'000; })) << "more than its attachments";
  const int pid = run.pidOf(GetParam());
  ASSERT_EQ(kill(pid, SIGKILL), 0);

  const nlohmann::json result = run.result();
  EXPECT_NE(result.at("exit_code"), 0);
  EXPECT_NE(result.at("reason").get<std::string>().find(GetParam()), std::string::npos) << result;
  // The cell is free again, and the recording up to the end is there.
  EXPECT_EQ(bench.baton({"status"}).exit_code, 3);
  const mcap::Reader reader(run.recording);
  EXPECT_GT(reader.statistics().message_count, 0U);
  EXPECT_EQ(reader.info().is_complete, GetParam() != "recorder");
}

INSTANTIATE_TEST_SUITE_P(Each, KilledService, ::testing::Values("plant", "environment", "trajectory", "recorder"),
                         [](const auto& service) { return service.param; });

TEST(Fault, AKilledSupervisorTakesItsProcessesAlong) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  run.waitForStep(200);
  const nlohmann::json cell =
      nlohmann::json::parse(std::ifstream(bench.folder() / "cells" / (std::to_string(bench.domain()) + "-lab.json")));
  ASSERT_EQ(kill(cell.at("supervisor_pid").get<int>(), SIGKILL), 0);
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
  EXPECT_EQ(bench.baton({"status"}).exit_code, 3);
  EXPECT_GT(mcap::Reader(run.recording).statistics().message_count, 0U);
  // And the cell can be used at once.
  EXPECT_EQ(bench.baton({"run", bench.write("short.yaml", shortContact())}).exit_code, 0);
}

class EndingSignal : public ::testing::TestWithParam<int> {};

TEST_P(EndingSignal, EndsARunInOrder) {
  Bench bench;
  const std::string recording = (bench.folder() / "stopped.mcap").string();
  const int pid = bench.start("baton",
                              {"run", bench.write("live.yaml", endlessContact()), "--out", recording, "--domain",
                               std::to_string(bench.domain())},
                              "run.log");
  ASSERT_TRUE(eventually([&] {
    const Finished status = bench.baton({"status", "--json"});
    return status.exit_code == 0 && nlohmann::json::parse(status.out).at("step") > 100;
  }));
  kill(pid, GetParam());
  EXPECT_EQ(bench.wait(pid), 130);
  EXPECT_TRUE(processesWith(bench.folder().string()).empty());
  const mcap::Reader reader(recording);
  EXPECT_TRUE(reader.info().is_complete);
  EXPECT_EQ(bench.baton({"bag", "info", recording}).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Each, EndingSignal, ::testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT),
                         [](const auto& signal) { return std::string(sigabbrev_np(signal.param)); });

TEST(Fault, AClosedTerminalDoesNotEndARunUnderNohup) {
  Bench bench;
  const auto before = signal(SIGHUP, SIG_IGN);  // what nohup does
  const int pid = bench.start(
      "baton",
      {"run", bench.write("live.yaml", endlessContact()), "--no-recording", "--domain", std::to_string(bench.domain())},
      "run.log");
  signal(SIGHUP, before);
  const auto reaches = [&](std::uint64_t step) {
    return eventually([&] {
      const Finished status = bench.baton({"status", "--json"});
      return status.exit_code == 0 && nlohmann::json::parse(status.out).at("step") > step;
    });
  };
  ASSERT_TRUE(reaches(100));
  for (const int one : processesWith(bench.folder().string())) kill(one, SIGHUP);
  kill(pid, SIGHUP);
  const std::uint64_t then = bench.batonJson({"status", "--json"}).at("step");
  EXPECT_TRUE(reaches(then + 100));
  kill(pid, SIGTERM);
  EXPECT_EQ(bench.wait(pid), 130);
}

class StoppedProcess : public ::testing::TestWithParam<std::string> {};

TEST_P(StoppedProcess, IsContinuedByDownAndTheRunEndsInOrder) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  run.waitForStep(200);
  const nlohmann::json cell =
      nlohmann::json::parse(std::ifstream(bench.folder() / "cells" / (std::to_string(bench.domain()) + "-lab.json")));
  const int pid = GetParam() == "supervisor" ? cell.at("supervisor_pid").get<int>() : run.pidOf(GetParam());
  ASSERT_GT(pid, 0);
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  const Finished down = bench.baton({"down", "--json"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  const nlohmann::json result = nlohmann::json::parse(down.out);
  EXPECT_EQ(result.at("state"), "stopped") << "killed, or given up on: " << result;
  EXPECT_EQ(result.at("reason"), "stopped from outside");
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
  const Finished log = bench.baton({"logs", "supervisor"});
  EXPECT_EQ(log.out.find("killing"), std::string::npos) << log.out;
  EXPECT_EQ(log.out.find("does not"), std::string::npos) << log.out;
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
}

INSTANTIATE_TEST_SUITE_P(Each, StoppedProcess,
                         ::testing::Values("supervisor", "plant", "recorder", "environment", "tracking"),
                         [](const auto& service) { return service.param; });

TEST(Fault, ARecorderThatWasStoppedClosesItsFileWhenTheRunEnds) {
  const Bench bench;
  const LiveRun run(bench, restingContact("duration_s: 3\nmode: realtime\nmax_missed_steps: 1000\n"));
  ASSERT_EQ(kill(run.pidOf("recorder"), SIGSTOP), 0);
  EXPECT_EQ(run.result().at("state"), "finished");
  const std::string log = readFile(run.folder() / "supervisor.log");
  EXPECT_EQ(log.find("does not close"), std::string::npos) << log;
  EXPECT_EQ(log.find("killing"), std::string::npos) << log;
}

TEST(Fault, AServiceThatSaysNothingIsInTheStatusAsSilent) {
  const Bench bench;
  const LiveRun run(bench, endlessContact(), {"--paused"});
  const int pid = run.pidOf("environment");
  ASSERT_GT(pid, 0);
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  std::map<std::string, std::string> states;
  const nlohmann::json status = bench.batonJson({"status", "--json"});
  for (const auto& service : status.at("services")) states[service.at("name")] = service.at("state");
  EXPECT_EQ(states["environment"], "silent") << status;
  EXPECT_EQ(states["plant"], "ready") << status;
  const Finished text = bench.baton({"status"});
  EXPECT_NE(text.out.find("said nothing for 5 s"), std::string::npos) << text.out;
  ASSERT_EQ(kill(pid, SIGCONT), 0);
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(Fault, AHolderThatDiesLosesTheBatonToTheFallback) {
  const Bench bench;
  const LiveRun run(bench, endlessContact("baton: {fallback: [force, pd]}\n"));
  run.waitForStep(200);
  ASSERT_EQ(kill(run.pidOf("tracking"), SIGKILL), 0);
  EXPECT_TRUE(eventually([&] {
    const std::string holder = bench.batonJson({"status", "--json"}).at("holder");
    return holder == "force" || holder == "pd";
  }));
  const nlohmann::json before = bench.batonJson({"status", "--json"});
  run.waitForStep(before.at("step").get<std::uint64_t>() + 200);
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  ASSERT_EQ(result.at("swaps").size(), 1U) << result;
  const auto& swap = result.at("swaps").at(0);
  EXPECT_TRUE(swap.at("done"));
  EXPECT_EQ(swap.at("outgoing"), "tracking");
  EXPECT_NE(swap.at("reason").get<std::string>().find("failover"), std::string::npos);
  for (const double change : swap.at("applied_effort_step")) EXPECT_LT(std::abs(change), 0.5);
  // Only what is fit may take over: force out of contact is not, and in contact it is.
  const std::uint64_t failed_at = swap.at("decided_at_step");
  const auto contacts = decodeStream<msg::Contact>(readStreams(run.recording)[{"contact", "environment"}]);
  const auto contact =
      std::find_if(contacts.begin(), contacts.end(), [&](const msg::Contact& one) { return one.step() == failed_at; });
  ASSERT_NE(contact, contacts.end());
  EXPECT_EQ(swap.at("incoming"), contact->penetration() > 0.0 ? "force" : "pd") << swap;
}

/// A second copy of one of the run's services, started by hand.
class SecondCopy : public ::testing::TestWithParam<std::string> {};

TEST_P(SecondCopy, GivesWayAndChangesNothing) {
  Bench bench;
  const LiveRun run(bench, endlessContact());
  const bool is_controller = GetParam() == "tracking";
  std::vector<std::string> arguments{"--scenario", (bench.folder() / "live.yaml").string(),
                                     "--run",      run.status.at("run").get<std::string>(),
                                     "--domain",   std::to_string(bench.domain())};
  if (is_controller) arguments.insert(arguments.end(), {"--name", GetParam()});
  const int second = bench.start("baton-" + (is_controller ? "controller" : GetParam()), arguments, "second.log");
  EXPECT_EQ(bench.wait(second), 3);
  const std::uint64_t step = bench.batonJson({"status", "--json"}).at("step");
  run.waitForStep(step + 100);
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
}

INSTANTIATE_TEST_SUITE_P(Of, SecondCopy, ::testing::Values("plant", "environment", "trajectory", "tracking"),
                         [](const auto& service) { return service.param; });

TEST(Fault, APlantWhoseServicesAnswerAnotherGivesWay) {
  // As when discovery tells of everybody but the run's own plant.
  Bench bench;
  const std::string run = "20000101-000000-0000";
  const std::string scenario = bench.write("short.yaml", shortContact());
  const int plant = bench.start(
      "baton-plant", {"--scenario", scenario, "--run", run, "--domain", std::to_string(bench.domain())}, "plant.log");
  dds::Participant participant(
      {.domain = bench.domain(), .partition = "lab/" + run, .cell = "lab", .run = run, .service = "environment"});
  dds::Writer<msg::ServiceStatus> writer(participant, dds::topics::kServiceStatus);
  msg::ServiceStatus status;
  status.name("environment");
  status.role("environment");
  status.state(msg::SERVICE_READY);
  status.plant({1, 2, 3});
  EXPECT_TRUE(writer.write(status));
  EXPECT_EQ(bench.wait(plant), 3);
}

TEST(Fault, ALeftOverPlantKeepsItsCell) {
  Bench bench;
  // A plant of an earlier run that waits for services that are gone; run ids sort by time.
  const std::string scenario = bench.write("short.yaml", shortContact());
  const std::string run = "20000101-000000-0000";
  std::filesystem::create_directories(bench.folder() / "runs" / run);
  const std::string key = bench.write("runs/" + run + "/key", dds::RunKey::fresh().text() + "\n");
  const int old = bench.start(
      "baton-plant", {"--scenario", scenario, "--run", run, "--key", key, "--domain", std::to_string(bench.domain())},
      "old.log");
  {
    dds::Participant onlooker({.domain = bench.domain(),
                               .partition = "lab/onlooker",
                               .cell = "lab",
                               .run = "onlooker",
                               .service = "onlooker"});
    ASSERT_TRUE(eventually([&] {
      const std::vector<dds::Peer> peers = onlooker.peers();
      return std::any_of(peers.begin(), peers.end(), [](const dds::Peer& peer) { return peer.service == "plant"; });
    })) << "it is there";
  }
  const Finished refused = bench.baton({"run", scenario});
  EXPECT_EQ(refused.exit_code, 3) << refused.out << refused.err;
  EXPECT_NE((refused.out + refused.err).find(run), std::string::npos) << refused.out << refused.err;
  // Another cell is free, and so is this one once the process is gone.
  EXPECT_EQ(bench.baton({"run", scenario, "--cell", "other"}).exit_code, 0);
  kill(old, SIGTERM);
  EXPECT_EQ(bench.wait(old), 0);
  EXPECT_EQ(bench.baton({"run", scenario}).exit_code, 0);
}

TEST(Fault, ALeftOverControllerOfAnotherRunIsNotHeard) {
  Bench bench;
  const std::string scenario = bench.write("short.yaml", shortContact());
  std::ignore = bench.start("baton-controller",
                            {"--scenario", scenario, "--name", "tracking", "--run", "20000101-000000-0000", "--domain",
                             std::to_string(bench.domain())},
                            "old.log");
  EXPECT_EQ(bench.baton({"run", scenario}).exit_code, 0);
}

TEST(Fault, ADeadControllerIsStartedAgainToStandBy) {
  const Bench bench;
  const LiveRun run(bench, endlessContact("rate: 1\nbaton: {fallback: [impedance]}\n"), {"--restarts", "1"});
  const int before = run.pidOf("pd");
  ASSERT_EQ(kill(before, SIGKILL), 0);
  run.waitForSuccessor("pd", before);
  EXPECT_TRUE(eventually([&] {
    for (const auto& controller : bench.batonJson({"controllers", "--json"})) {
      if (controller.at("name") == "pd" && controller.at("state") == "standby") return true;
    }
    return false;
  }));
  // It can hold the baton again, and the certificate does not vouch for what the dead process sent.
  const nlohmann::json swapped = bench.batonJson({"swap", "pd", "--force", "--json"});
  EXPECT_TRUE(swapped.at("done")) << swapped;
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_FALSE(result.at("recording").at("complete"));
  EXPECT_NE(result.at("reason").get<std::string>().find("pd"), std::string::npos) << result;
}

/// A part that answers every step from what it is told.
class RestartedPart : public ::testing::TestWithParam<std::string> {};

TEST_P(RestartedPart, GoesOnAtTheStepThatWaitsForIt) {
  const Bench bench;
  const nlohmann::json undisturbed =
      bench.batonJson({"run", bench.write("undisturbed.yaml", shortContact()), "--no-recording", "--json"});
  const LiveRun run(bench, shortContact(), {"--paused", "--restarts", "1"});
  ASSERT_EQ(bench.baton({"sim", "step", "150"}).exit_code, 0);
  // Stopped first, so that it owes an answer when it dies.
  const int pid = run.pidOf(GetParam());
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  ASSERT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  nlohmann::json before;
  EXPECT_TRUE(eventually([&] {
    nlohmann::json now = bench.batonJson({"status", "--json"});
    const bool stands = before.is_object() && now.at("waiting_for") != "" && now.at("step") == before.at("step");
    before = std::move(now);
    return stands;
  })) << before;
  ASSERT_EQ(kill(pid, SIGKILL), 0);

  const nlohmann::json result = run.result();
  EXPECT_EQ(result.at("state"), "finished") << result;
  EXPECT_EQ(result.at("chain_hash"), undisturbed.at("chain_hash"));
  EXPECT_EQ(result.at("exit_code"), 1) << "a process died: " << result;
  EXPECT_NE(result.at("reason").get<std::string>().find(GetParam()), std::string::npos) << result;
  EXPECT_FALSE(result.at("recording").at("complete")) << "nobody vouches for what the dead one sent";
  EXPECT_EQ(bench.batonJson({"bag", "hash", run.recording, "--json"}).at("hash"), undisturbed.at("chain_hash"));
}

INSTANTIATE_TEST_SUITE_P(Each, RestartedPart, ::testing::Values("environment", "trajectory"),
                         [](const auto& service) { return service.param; });

TEST(Fault, WithoutAFallbackTheBrakeHolds) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  run.waitForStep(200);
  ASSERT_EQ(kill(run.pidOf("tracking"), SIGKILL), 0);
  EXPECT_TRUE(eventually([&] { return bench.batonJson({"status", "--json"}).at("holder") == ""; }));
  // Further than the recorder's credit: nothing waits for commands that nobody sends.
  run.waitForStep(bench.batonJson({"status", "--json"}).at("step").get<std::uint64_t>() + 1000);
  // The brake holds the arm where it is.
  EXPECT_TRUE(bench.batonJson({"swap", "impedance", "--json"}).at("done"));
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_EQ(result.at("exit_code"), 1);
  EXPECT_NE(result.at("reason").get<std::string>().find("tracking"), std::string::npos) << result;
}

TEST(Fault, AKilledRecorderLeavesWhatItHasShown) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  run.waitForStep(200);
  ASSERT_EQ(bench.baton({"sim", "pause"}).exit_code, 0);
  std::uint64_t shown = 0;
  EXPECT_TRUE(eventually([&] {
    shown = bench.batonJson({"record", "status", "--json"}).at("messages");
    return shown > 1000;
  }));
  ASSERT_EQ(kill(run.pidOf("recorder"), SIGKILL), 0);
  std::ignore = run.result();
  EXPECT_GE(mcap::Reader(run.recording).statistics().message_count, shown);
}

/// Ctrl-C when so many of the run's processes are there: from the very first to all of them.
class EarlyCtrlC : public ::testing::TestWithParam<std::size_t> {};

TEST_P(EarlyCtrlC, LeavesNothingBehind) {
  Bench bench;
  const std::string scenario = bench.write("live.yaml", endlessContact());
  const int pid = bench.start("baton", {"run", scenario, "--domain", std::to_string(bench.domain())}, "run.log");
  ASSERT_TRUE(eventually([&] { return processesWith(bench.folder().string()).size() >= GetParam(); }));
  kill(pid, SIGINT);
  EXPECT_EQ(bench.wait(pid), 130);
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
  EXPECT_EQ(bench.baton({"status"}).exit_code, 3);
}

INSTANTIATE_TEST_SUITE_P(Processes, EarlyCtrlC, ::testing::Values(1, 2, 3, 6, 9));

TEST(Fault, CtrlCWhileARunIsStartedIsNoFailureOfIt) {
  Bench bench;
  for (const char* name : {"bin", "share"}) fs::create_directory(bench.folder() / name);
  fs::copy_file(programFolder() / "baton", bench.folder() / "bin/baton");
  fs::create_directory_symlink(deployFolder(), bench.folder() / "share/baton");
  // One that gets nowhere. It inherits a SIGTERM that is held, and a SIGCONT follows that.
  const std::string supervisor =
      bench.write("bin/baton-supervisor",
                  "#!/bin/sh\nsleep 1000 &\ntrap 'kill -9 $!; exit 130' TERM CONT\n: >\"$0.began\"\nwait\n");
  fs::permissions(supervisor, fs::perms::owner_all);
  const int pid = bench.start(
      bench.folder() / "bin/baton",
      {"up", bench.write("live.yaml", endlessContact()), "--domain", std::to_string(bench.domain())}, "up.log");
  ASSERT_TRUE(eventually([&] { return fs::exists(supervisor + ".began"); }));
  kill(pid, SIGINT);
  EXPECT_EQ(bench.wait(pid), 130);
  EXPECT_NE(readFile(bench.folder() / "up.log").find("baton: interrupted before the run began\n"), std::string::npos)
      << readFile(bench.folder() / "up.log");
}

TEST(Fault, AServiceThatCannotStartIsNamed) {
  const Bench bench;
  // The recording cannot be made: the folder goes away between the check and the start, as on a full or read-only disk.
  const std::string scenario = bench.write("short.yaml", shortContact());
  const Finished finished = runProgram(programFolder() / "baton-supervisor",
                                       {"--scenario", scenario, "--domain", std::to_string(bench.domain()), "--out",
                                        (bench.folder() / "missing/run.mcap").string()},
                                       bench.folder());
  EXPECT_EQ(finished.exit_code, 3) << finished.err;
  EXPECT_NE(finished.err.find("recorder could not start"), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("missing/run.mcap"), std::string::npos) << finished.err;
  EXPECT_TRUE(processesWith(bench.folder().string()).empty());
}

}  // namespace
}  // namespace baton::test
