#include "kills/kill_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

Scenario killsScenario() { return loadScenario((deployFolder() / "scenarios/kills.yaml").string()); }

TEST(KillCase, TheSameSeedGivesTheSameKills) {
  const Scenario scenario = killsScenario();
  const auto list = [&](std::uint64_t seed) {
    std::string text;
    for (const Kill& kill : drawKills(scenario, seed, 100)) {
      text += std::string(toString(kill.of.victim)) + toString(kill.of.way) + kill.service + std::to_string(kill.step);
    }
    return text;
  };
  EXPECT_EQ(list(1), list(1));
  EXPECT_NE(list(1), list(2));
}

TEST(KillCase, EveryCaseHasItsTurnAndItsRoom) {
  const Scenario scenario = killsScenario();
  const std::vector<Kill> kills = drawKills(scenario, 7, 240);
  for (const KillCase& of : killCases()) {
    EXPECT_EQ(std::count_if(kills.begin(), kills.end(), [&](const Kill& kill) { return kill.of == of; }), 20);
  }
  const std::uint64_t swap = scenario.swaps.front().at_step;
  bool is_one_in_the_handover = false;
  for (const Kill& kill : kills) {
    EXPECT_GE(kill.step, 100U);
    EXPECT_LE(kill.step + kStopped_steps, scenario.end_step);
    if (kill.of.victim != Victim::kStandby) continue;
    EXPECT_NE(kill.service, scenario.active) << "at step " << kill.step << " it holds the baton, or did";
    const bool is_late = kill.service == scenario.swaps.front().to && kill.step >= swap;
    EXPECT_FALSE(is_late) << "at step " << kill.step << " it holds the baton";
    const bool is_planned = kill.service == scenario.swaps.front().to && kill.step + 6 >= swap;
    is_one_in_the_handover = is_one_in_the_handover || is_planned;
  }
  EXPECT_TRUE(is_one_in_the_handover);
}

TEST(KillCase, ARunWithoutRoomIsRefused) {
  Scenario scenario = killsScenario();
  scenario.end_step = 400;
  EXPECT_THROW((void)drawKills(scenario, 1, 12), UsageError);
  scenario = killsScenario();
  scenario.swaps.clear();
  EXPECT_THROW((void)drawKills(scenario, 1, 12), UsageError);
}

}  // namespace
}  // namespace baton::test
