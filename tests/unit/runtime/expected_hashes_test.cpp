/// The hash of every scenario that comes with Baton and runs in one process, as it is on every processor, with every
/// compiler and release. A change that moves one of them changes the numbers that people get: it must be meant, and say
/// so where it is made. tests/expected_hashes.txt holds them; `baton run NAME --in-process` prints one.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "bad_input.hpp"
#include "runtime/monolithic_run.hpp"
#include "runtime/scenario.hpp"

namespace baton {
namespace {

using test::deployPath;

std::map<std::string, std::uint64_t> expectedHashes() {
  std::ifstream file(deployPath("../tests/expected_hashes.txt"));
  std::map<std::string, std::uint64_t> hashes;
  std::string scenario;
  for (std::uint64_t hash = 0; file >> scenario >> hash;) hashes[scenario] = hash;
  return hashes;
}

TEST(ExpectedHashes, AreThoseOfEveryScenario) {
  const std::map<std::string, std::uint64_t> expected = expectedHashes();
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(deployPath("scenarios"))) {
    if (entry.path().extension() != ".yaml") continue;
    const Scenario scenario = loadScenario(entry.path().string());
    // Without an end, or with decisions that only the distributed system makes: tests/integration runs those.
    if (scenario.end_step == 0 || scenario.mode == SimMode::kRealtime || !scenario.swaps.empty() ||
        !scenario.failures.empty() || !scenario.faults.empty()) {
      continue;
    }
    SCOPED_TRACE(scenario.name);
    ASSERT_TRUE(expected.contains(scenario.name)) << "tests/expected_hashes.txt does not list it";
    MonolithicRun run(scenario);
    while (run.step()) {
    }
    EXPECT_EQ(run.failure(), "");
    EXPECT_EQ(run.chainHash(), expected.at(scenario.name));
    ++count;
  }
  EXPECT_GE(count, 40U);
}

}  // namespace
}  // namespace baton
