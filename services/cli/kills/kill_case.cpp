#include "kills/kill_case.hpp"

#include <algorithm>
#include <random>

#include "base/error.hpp"
#include "runtime/service_options.hpp"

namespace baton {

const char* toString(Victim victim) {
  switch (victim) {
    case Victim::kHolder: return "holder";
    case Victim::kStandby: return "standby";
    case Victim::kEnvironment: return "environment";
    case Victim::kTrajectory: return "trajectory";
    case Victim::kRecorder: return "recorder";
  }
  return "?";
}

const char* toString(Way way) {
  switch (way) {
    case Way::kKilled: return "killed";
    case Way::kRestarted: return "restarted";
    case Way::kStopped: return "stopped";
  }
  return "?";
}

const std::vector<KillCase>& killCases() {
  static const std::vector<KillCase> kCases{
      {Victim::kHolder, Way::kKilled},        {Victim::kHolder, Way::kStopped},
      {Victim::kStandby, Way::kKilled},       {Victim::kStandby, Way::kStopped},
      {Victim::kEnvironment, Way::kKilled},   {Victim::kEnvironment, Way::kRestarted},
      {Victim::kEnvironment, Way::kStopped},  {Victim::kTrajectory, Way::kKilled},
      {Victim::kTrajectory, Way::kRestarted}, {Victim::kTrajectory, Way::kStopped},
      {Victim::kRecorder, Way::kKilled},      {Victim::kRecorder, Way::kStopped}};
  return kCases;
}

std::vector<Kill> drawKills(const Scenario& scenario, std::uint64_t seed, std::size_t count) {
  // Behind the last one there has to be room for what follows: a recorder that is stopped is missed when the plant has
  // used up its credit.
  const std::uint64_t room = std::max(kStopped_steps, scenario.recording.credit_steps) + kFence_steps + 20;
  const std::uint64_t first = scenario.end_step / 10;
  if (scenario.end_step < 2 * room || scenario.swaps.empty() || scenario.controllers.size() < 3 ||
      !scenario.hasEnvironment() || scenario.mode != SimMode::kLockstep) {
    throw UsageError(scenario.file + ": expected a run in lockstep of at least " + std::to_string(2 * room) +
                     " steps, with a wall, three controllers and a planned handover");
  }
  const std::uint64_t last = scenario.end_step - room;
  const PlannedSwap& swap = scenario.swaps.front();
  std::mt19937_64 random(seed);
  const auto between = [&](std::uint64_t low, std::uint64_t high) { return low + random() % (high - low + 1); };

  std::vector<Kill> kills;
  for (std::size_t i = 0; i < count; ++i) {
    const KillCase& of = killCases()[i % killCases().size()];
    const bool is_near = (i / killCases().size()) % 2 == 1;
    Kill kill{.of = of, .step = between(first, last), .service = toString(of.victim), .number = i + 1};
    if (of.victim == Victim::kHolder || of.victim == Victim::kStandby) {
      const std::uint64_t margin = scenario.baton.margin_steps;
      if (is_near) kill.step = between(swap.at_step - margin - 3, swap.at_step + 2);
      // Not the first holder, and the next one only before it holds.
      std::vector<std::string> standing_by;
      for (const ControllerConfig& one : scenario.controllers) {
        const bool stands_by = one.name != scenario.active && (one.name != swap.to || kill.step + 2 < swap.at_step);
        if (stands_by) standing_by.push_back(one.name);
      }
      kill.service = of.victim == Victim::kHolder ? "" : standing_by[between(0, standing_by.size() - 1)];
    }
    // A recorder that writes once a second has something to show only later; see killRun().
    if (of == KillCase{Victim::kRecorder, Way::kKilled}) kill.step = between((first + last) / 2, last);
    kills.push_back(kill);
  }
  return kills;
}

}  // namespace baton
