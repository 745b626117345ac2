// Runs in which a script takes the place of one program: what no sound program does.
#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

#include "dds/typed.hpp"
#include "runtime/cell.hpp"
#include "runtime/paths.hpp"
#include "runtime/service_options.hpp"
#include "support/live_run.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

struct StandIn {
  StandIn(const std::string& program, const std::string& script)
      : programs(programsBut(bench, program, script)),
        arguments{"run", bench.write("run.yaml", endlessContact()), "--no-recording", "--domain",
                  std::to_string(bench.domain())} {}
  [[nodiscard]] Finished run() const { return runProgram(programs / "baton", arguments, bench.folder()); }

  Bench bench;
  fs::path programs;
  std::vector<std::string> arguments;
};

TEST(StandIn, OfARunThatFinishedAndThenWasAbortedTheLastWordCounts) {
  // The test speaks for the plant. The environment does not end when it is asked to, so what is said by then is heard.
  StandIn run("baton-plant", "exec sleep 1000");
  Bench& bench = run.bench;
  const std::string may_end = (bench.folder() / "may_end").string();
  standIn(bench, "baton-environment", "trap '' TERM\nwhile [ ! -e " + may_end + " ]; do sleep 0.1; done");
  const int command = bench.start((run.programs / "baton").string(), run.arguments, "run.log");
  fs::path folder;  // the run's
  ASSERT_TRUE(eventually([&] {
    std::error_code not_yet;
    for (const auto& entry : fs::directory_iterator(bench.folder() / "runs", not_yet)) {
      if (fs::exists(entry.path() / "key")) folder = entry.path();
    }
    return !folder.empty();
  }));
  dds::Participant plant({.domain = bench.domain(),
                          .partition = "lab/" + folder.filename().string(),
                          .cell = "lab",
                          .run = folder.filename().string(),
                          .service = kPlantName,
                          .role = dds::Role::kPlant,
                          .key = readKey((folder / "key").string())});
  dds::Writer<msg::SimStatus> status(plant, dds::topics::kSimStatus);
  const auto say = [&](msg::SimState state) {
    msg::SimStatus word;
    word.state(state);
    word.reason(state == msg::SIM_STATE_ABORTED ? "a late reason" : "");
    status.write(word);
    ASSERT_TRUE(status.raw().waitForAcknowledgments(60'000));
  };
  const auto supervisorLog = [&] { return readFile(folder / "supervisor.log"); };
  constexpr std::size_t kReaders = 7;  // supervisor, trajectory, four controllers, and the command line
  ASSERT_TRUE(eventually([&] { return status.raw().matched().size() >= kReaders; }));
  say(msg::SIM_STATE_RUNNING);
  say(msg::SIM_STATE_FINISHED);
  ASSERT_TRUE(eventually([&] { return supervisorLog().find("ended service=plant") != std::string::npos; }));
  say(msg::SIM_STATE_ABORTED);
  std::ignore = bench.write("may_end", "");
  EXPECT_EQ(bench.wait(command), 4) << readFile(bench.folder() / "run.log");
  EXPECT_NE(readFile(bench.folder() / "run.log").find("a late reason"), std::string::npos);
}

TEST(StandIn, AStartThatHangsSaysWhomItWaitsFor) {
  const StandIn run("baton-environment", "exec sleep 1000");
  const Finished finished = run.run();
  EXPECT_EQ(finished.exit_code, 3) << finished.out << finished.err;
  const std::string said = finished.out + finished.err, words = "it waits for ";
  const std::size_t at = said.find(words);
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_NE(said.find(kEnvironmentName, at), std::string::npos) << said;
}

TEST(StandIn, ASupervisorThatEndsWithoutAWordIsToldOfWithWhatMayBeWrong) {
  const StandIn run("baton-supervisor", "exit 1");
  const Finished finished = run.run();
  EXPECT_EQ(finished.exit_code, 3) << finished.out << finished.err;
  EXPECT_NE(finished.err.find("is empty, as a full disk, too few files that a process may open"), std::string::npos)
      << finished.err;
}

}  // namespace
}  // namespace baton::test
