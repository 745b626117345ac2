// The scenarios whose handovers only the distributed system makes; tests/hashes has the others.
#include "hashes/expected.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

TEST(ExpectedHashes, AreThoseOfEveryScenarioThatHandsOver) {
  const Bench bench;
  std::map<std::string, std::uint64_t> expected = expectedHashes();
  std::size_t count = 0;
  for (const Scenario& scenario : determinedScenarios()) {
    if (!needsProcesses(scenario)) continue;
    SCOPED_TRACE(scenario.name);
    const nlohmann::json result = bench.batonJson({"run", scenario.file, "--no-recording", "--json"});
    EXPECT_EQ(result.at("exit_code"), 0) << result;
    EXPECT_EQ(result.at("chain_hash"), std::to_string(expected[scenario.name])) << result.at("reason");
    ++count;
  }
  EXPECT_GE(count, 6U);
}

}  // namespace
}  // namespace baton::test
