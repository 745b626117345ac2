/// Who is killed, how and when: drawn from a seed, so that a list of kills can be had again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/scenario.hpp"

namespace baton {

enum class Victim { kHolder, kStandby, kEnvironment, kTrajectory, kRecorder };
enum class Way {
  kKilled,
  kRestarted,  // killed, and started again
  kStopped     // SIGSTOP; goes on when the run has gone on without it for a while, or is over
};
[[nodiscard]] const char* toString(Victim victim);
[[nodiscard]] const char* toString(Way way);

struct KillCase {
  Victim victim = Victim::kHolder;
  Way way = Way::kKilled;
  bool operator==(const KillCase&) const = default;
};

/// All cases. Who keeps a state, or a file, is not started again.
[[nodiscard]] const std::vector<KillCase>& killCases();

struct Kill {
  KillCase of;
  std::uint64_t step = 0;    // at which it happens, or up to kFence_steps later
  std::string service;       // empty: whoever holds the baton then
  std::uint64_t number = 0;  // from 1
};

/// `count` kills, the cases in turn. Every other one of a controller is near a handover that the scenario plans.
/// Throws UsageError when the scenario does not have the parts or the length for them.
[[nodiscard]] std::vector<Kill> drawKills(const Scenario& scenario, std::uint64_t seed, std::size_t count);

/// A kill happens at most so many steps later than drawn.
inline constexpr std::uint64_t kFence_steps = 20;
/// For so many steps the run goes on without one that was stopped.
inline constexpr std::uint64_t kStopped_steps = 150;

}  // namespace baton
