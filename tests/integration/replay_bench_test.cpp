// The bench of replays: that it measures. What it measures is the machine's business.
#include <gtest/gtest.h>

#include "support/processes.hpp"

namespace baton::test {
namespace {

TEST(ReplayBench, MeasuresReplaysBesideALoopThatSleepsAndSeeks) {
  const Bench bench;
  const Finished finished = runProgram(programFolder() / "baton-bench-replay",
                                       {"--rounds", "2", "--seconds", "1", "--seek-mb", "2", "--json"}, bench.folder());
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const nlohmann::json report = nlohmann::json::parse(finished.out);
  EXPECT_EQ(report.at("messages"), 1000);
  for (const char* name : {"sleep", "replay", "reader", "seek"}) {
    SCOPED_TRACE(name);
    const nlohmann::json& measured = report.at(name);
    EXPECT_EQ(measured.at("p50_us").at("rounds").size(), std::string(name) == "seek" ? 1U : 2U);
    EXPECT_GT(measured.at("p50_us").at("median"), 0.0);
    EXPECT_LE(measured.at("p50_us").at("median"), measured.at("p99_us").at("median"));
    EXPECT_LE(measured.at("p99_us").at("median"), measured.at("max_us").at("median"));
  }
  EXPECT_EQ(report.at("reached").get<bool>(),
            report.at("replay").at("p99_us").at("median") < report.at("target_p99_us"));
  EXPECT_NE(finished.err.find("lateness of the replay's messages"), std::string::npos) << finished.err;  // the table
}

}  // namespace
}  // namespace baton::test
