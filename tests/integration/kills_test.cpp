// One kill of every kind, on real processes.
#include <gtest/gtest.h>

#include <set>

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

TEST(Kills, AScenarioWithoutRoomForThemIsRefused) {
  const Bench bench;
  const Finished refused = bench.baton({"kills", "link1"});
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_NE(refused.err.find("a planned handover"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace baton::test
