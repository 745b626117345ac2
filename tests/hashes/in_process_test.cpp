// The scenarios that one process can run. tests/hashes/everywhere runs this with other compilers and processors.
#include "hashes/expected.hpp"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <vector>

#include "control/law.hpp"
#include "runtime/monolithic_run.hpp"

namespace baton::test {
namespace {

std::string lawOf(const Scenario& scenario) {
  for (const ControllerConfig& controller : scenario.controllers) {
    if (controller.name == scenario.active) return controller.law;
  }
  return {};
}

/// All that one process can run; with BATON_HASHES_BRIEF of each law the shortest, for a build that takes a minute for
/// what others do in a second.
std::vector<Scenario> scenariosToRun() {
  std::vector<Scenario> all = determinedScenarios();
  std::erase_if(all, needsProcesses);
  if (std::getenv("BATON_HASHES_BRIEF") == nullptr) return all;
  const auto work = [](const Scenario& scenario) {
    return scenario.end_step * static_cast<std::uint64_t>(scenario.substeps);
  };
  std::ranges::stable_sort(all, {}, work);
  std::set<std::string> laws;
  std::erase_if(all, [&](const Scenario& scenario) { return !laws.insert(lawOf(scenario)).second; });
  return all;
}

TEST(ExpectedHashes, AreListedForTheScenariosThereAre) {
  std::map<std::string, std::uint64_t> expected = expectedHashes();
  for (const Scenario& scenario : determinedScenarios()) {
    EXPECT_EQ(expected.erase(scenario.name), 1U) << "tests/hashes/expected.txt does not list " << scenario.name;
  }
  for (const auto& [name, hash] : expected)
    ADD_FAILURE() << "tests/hashes/expected.txt lists " << name << ", no scenario";
}

TEST(ExpectedHashes, AreThoseOfEveryScenarioInOneProcess) {
  std::map<std::string, std::uint64_t> expected = expectedHashes();
  std::set<std::string> laws;
  for (const Scenario& scenario : scenariosToRun()) {
    SCOPED_TRACE(scenario.name);
    MonolithicRun run(scenario);
    while (run.step()) {
    }
    EXPECT_EQ(run.whatWentWrong(), "");
    EXPECT_EQ(run.chainHash(), expected[scenario.name]);
    laws.insert(lawOf(scenario));
  }
  for (const LawInfo& law : allLaws()) EXPECT_TRUE(laws.contains(law.name)) << "no scenario runs " << law.name;
}

}  // namespace
}  // namespace baton::test
