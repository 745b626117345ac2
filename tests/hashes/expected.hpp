/// The hash of every scenario that comes with Baton, as it is on every processor, with every compiler and on every
/// release of Debian: the file expected.txt. A change that moves one of them changes the numbers that people get: it is
/// a decision, and its commit says why. `baton run NAME`, with --in-process where no handover is planned, prints one.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "runtime/scenario.hpp"
#include "support/checkout.hpp"

namespace baton::test {

/// By the scenario's name. Adds a failure to the test when the file cannot be read to its end.
inline std::map<std::string, std::uint64_t> expectedHashes() {
  std::ifstream file(checkoutFolder() / "tests/hashes/expected.txt");
  EXPECT_TRUE(file.is_open()) << "cannot read tests/hashes/expected.txt";
  std::map<std::string, std::uint64_t> hashes;
  std::string scenario;
  for (std::uint64_t hash = 0; file >> scenario >> hash;) hashes[scenario] = hash;
  EXPECT_TRUE(file.eof()) << "tests/hashes/expected.txt: expected a name and a hash per line";
  return hashes;
}

/// Whether only the distributed system makes its decisions: `--in-process` refuses it.
inline bool needsProcesses(const Scenario& scenario) {
  return !scenario.swaps.empty() || !scenario.failures.empty() || !scenario.faults.empty() || !scenario.stops.empty();
}

/// All scenarios of deploy/scenarios whose bytes are determined: those in lockstep and with an end.
inline std::vector<Scenario> determinedScenarios() {
  std::vector<Scenario> scenarios;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(deployFolder() / "scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    Scenario scenario = loadScenario(entry.path().string());
    if (scenario.end_step > 0 && scenario.mode != SimMode::kRealtime) scenarios.push_back(std::move(scenario));
  }
  return scenarios;
}

}  // namespace baton::test
