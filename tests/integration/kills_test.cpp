// One kill of every kind, on real processes.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <system_error>

#include "dds/typed.hpp"
#include "runtime/paths.hpp"
#include "runtime/service_options.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

TEST(Kills, EveryRunEndsAsToldAndRepeatsBitForBit) {
  const Bench bench;
  const Finished finished = bench.baton({"kills", "--runs", "12", "--seed", "3", "--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const nlohmann::json report = nlohmann::json::parse(finished.out);
  EXPECT_EQ(report.at("failed"), 0);
  std::set<std::string> kinds;
  for (const auto& trial : report.at("trials")) {
    kinds.insert(trial.at("victim").get<std::string>() + " " + trial.at("way").get<std::string>());
    EXPECT_TRUE(trial.at("ended_as_told")) << trial;
    EXPECT_TRUE(trial.at("repeated")) << trial;
    EXPECT_GT(trial.at("largest_torque"), 0.0) << trial;
    EXPECT_LE(trial.at("largest_torque"), 1.0) << trial;
    EXPECT_NE(trial.at("service"), "") << trial;
  }
  EXPECT_EQ(kinds.size(), 12U);
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
}

/// When Ctrl-C comes: a file is there, with this text. After the death of the victim the run's own exit code says what
/// became of it, not that an end was asked for.
struct Moment {
  const char* name;
  const char* file;
  const char* text;
};

bool hasCome(const Moment& moment, const std::filesystem::path& folder) {
  std::error_code still_changing;
  std::filesystem::recursive_directory_iterator entry(folder, still_changing);
  for (; entry != std::filesystem::recursive_directory_iterator(); entry.increment(still_changing)) {
    if (entry->path().filename() != moment.file) continue;
    std::ostringstream text;
    text << std::ifstream(entry->path()).rdbuf();
    if (text.str().find(moment.text) != std::string::npos) return true;
  }
  return false;
}

class InterruptedKills : public ::testing::TestWithParam<Moment> {};

TEST_P(InterruptedKills, EndsAtOnce) {
  Bench bench;
  const int pid = bench.start("baton",
                              {"kills", "--runs", "200", "--out", (bench.folder() / "kills").string(), "--domain",
                               std::to_string(bench.domain())},
                              "kills.log");
  ASSERT_TRUE(eventually([&] { return hasCome(GetParam(), bench.folder()); }));
  kill(pid, SIGINT);
  EXPECT_EQ(bench.wait(pid), 130);
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
}

INSTANTIATE_TEST_SUITE_P(In, InterruptedKills,
                         ::testing::Values(Moment{"ARun", "supervisor.log", "signal 9"},
                                           Moment{"ARepetition", "rerun.mcap", ""}),
                         [](const auto& moment) { return std::string(moment.param.name); });

/// Says of a run's controllers that they are this process, in each run of a cell that it finds.
class Liar {
 public:
  explicit Liar(pid_t process) { status_.state(msg::SERVICE_READY), status_.pid(process); }
  void speak(const Bench& bench) {
    std::error_code none_yet;
    for (const auto& file : std::filesystem::directory_iterator(bench.folder() / "kills/home/cells", none_yet)) {
      const auto run = nlohmann::json::parse(std::ifstream(file.path()), nullptr, false);
      if (run.is_object() && run.at("run") != run_) join(bench, run.at("cell"), run.at("run"));
    }
    if (!writer_) return;
    for (const char* name : {"tracking", "joint", "impedance", "force", "pd", "plant", "environment", "trajectory"}) {
      status_.name(name);
      writer_->write(status_);
    }
    if (!writer_->raw().matched().empty()) matched_.insert(run_);
  }
  /// Runs in which it had readers.
  [[nodiscard]] std::size_t runs() const { return matched_.size(); }

 private:
  void join(const Bench& bench, const std::string& cell, const std::string& run) {
    writer_.reset();
    participant_ = std::make_unique<dds::Participant>(dds::ParticipantOptions{
        .domain = bench.domain(), .partition = cell + "/" + run, .cell = cell, .run = run, .service = kSupervisorName});
    writer_ = std::make_unique<dds::Writer<msg::ServiceStatus>>(*participant_, dds::topics::kServiceStatus);
    run_ = run;
  }

  msg::ServiceStatus status_;
  std::string run_;
  std::set<std::string> matched_;
  std::unique_ptr<dds::Participant> participant_;
  std::unique_ptr<dds::Writer<msg::ServiceStatus>> writer_;
};

TEST(Kills, AStrangerCannotNameTheVictim) {
  Bench bench;
  const pid_t bystander = fork();
  if (bystander == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    pause();
    _exit(0);
  }
  const int pid = bench.start("baton",
                              {"kills", "--runs", "2", "--out", (bench.folder() / "kills").string(), "--domain",
                               std::to_string(bench.domain())},
                              "kills.log");
  Liar liar(bystander);
  EXPECT_TRUE(eventually([&] {
    liar.speak(bench);
    return readFile("/proc/" + std::to_string(pid) + "/stat").find(") Z ") != std::string::npos;  // it has ended
  }));
  EXPECT_EQ(bench.wait(pid), 0) << readFile(bench.folder() / "kills.log");
  EXPECT_GE(liar.runs(), 2U);
  int how = 0;
  EXPECT_EQ(waitpid(bystander, &how, WNOHANG), 0) << "the bystander is dead";
  kill(bystander, SIGKILL);
  waitpid(bystander, &how, 0);
}

TEST(Kills, AScenarioWithoutRoomForThemIsRefused) {
  const Bench bench;
  const Finished refused = bench.baton({"kills", "link1"});
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_NE(refused.err.find("a planned handover"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace baton::test
