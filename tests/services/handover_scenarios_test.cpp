// The scenarios behind the pair table go round all ordered pairs of all laws.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>

#include "control/law.hpp"
#include "runtime/scenario.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

using Pairs = std::set<std::pair<std::string, std::string>>;

/// Of laws, as the scenario plans them.
struct Walk {
  std::map<std::string, std::string> laws;  // by controller
  Pairs done;
  Pairs refused;
  std::size_t swaps = 0;
};

Walk walkOf(const std::string& name) {
  const Scenario scenario = loadScenario((deployFolder() / "scenarios/handover" / (name + ".yaml")).string());
  Walk walk;
  for (const ControllerConfig& one : scenario.controllers) walk.laws[one.name] = one.law;
  std::string holder = scenario.active;
  for (const PlannedSwap& swap : scenario.swaps) {
    const bool is_refused = swap.expect == SwapExpectation::kRefused;
    (is_refused ? walk.refused : walk.done).insert({walk.laws.at(holder), walk.laws.at(swap.to)});
    if (!is_refused) holder = swap.to;
    ++walk.swaps;
  }
  return walk;
}

/// Of all laws; `fit` says of one whether it may hold the baton.
template <class Fit>
void expectAllPairs(const Walk& walk, const Fit& fit) {
  std::set<std::string> laws;
  for (const auto& [controller, law] : walk.laws) laws.insert(law);
  Pairs done, refused;
  for (const LawInfo& from : allLaws()) {
    EXPECT_TRUE(laws.contains(from.name)) << from.name;
    for (const LawInfo& to : allLaws()) {
      if (from.name != to.name && fit(from)) (fit(to) ? done : refused).insert({from.name, to.name});
    }
  }
  EXPECT_EQ(walk.done, done);
  EXPECT_EQ(walk.refused, refused);
  EXPECT_EQ(walk.swaps, done.size() + refused.size()) << "each once";
}

TEST(HandoverScenarios, InContactEveryLawHandsOverToEveryOther) {
  for (const char* name : {"contact_rest", "contact_moving"}) {
    SCOPED_TRACE(name);
    expectAllPairs(walkOf(name), [](const LawInfo&) { return true; });
  }
}

TEST(HandoverScenarios, OutOfContactTheLawsThatNeedItAreRefusedToEachOfTheOthers) {
  for (const char* name : {"free_rest", "free_moving"}) {
    SCOPED_TRACE(name);
    expectAllPairs(walkOf(name), [](const LawInfo& law) { return !law.requires_contact; });
  }
}

}  // namespace
}  // namespace baton::test
