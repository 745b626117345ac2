// One kill of every kind, on real processes.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

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

/// Ctrl-C when this file has appeared: the run's own exit code may say what became of the victim instead.
class InterruptedKills : public ::testing::TestWithParam<const char*> {};

TEST_P(InterruptedKills, EndsAtOnce) {
  Bench bench;
  const int pid = bench.start("baton",
                              {"kills", "--runs", "200", "--out", (bench.folder() / "kills").string(), "--domain",
                               std::to_string(bench.domain())},
                              "kills.log");
  ASSERT_TRUE(eventually([&] {
    std::error_code still_changing;
    const std::filesystem::recursive_directory_iterator all(bench.folder() / "kills", still_changing), end;
    return std::any_of(all, end, [](const auto& entry) { return entry.path().filename() == GetParam(); });
  }));
  kill(pid, SIGINT);
  EXPECT_EQ(bench.wait(pid), 130);
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
}

INSTANTIATE_TEST_SUITE_P(In, InterruptedKills, ::testing::Values("001-holder-killed.mcap", "rerun.mcap"),
                         [](const auto& file) { return std::string(file.index == 0 ? "ARun" : "ARepetition"); });

TEST(Kills, AScenarioWithoutRoomForThemIsRefused) {
  const Bench bench;
  const Finished refused = bench.baton({"kills", "link1"});
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_NE(refused.err.find("a planned handover"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace baton::test
