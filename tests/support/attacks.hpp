/// What a process without the key of a run can say to it over DDS, without forged RTPS.
#pragma once

#include <functional>
#include <span>

#include "support/live_run.hpp"
#include "support/stranger.hpp"

namespace baton::test {

inline constexpr const char* kWritesOn = "a stranger writes";

struct Attack {
  const char* name;
  const char* claims;  // the service it pretends to be
  /// Called at each state that the plant publishes, with that state.
  std::function<void(Stranger&, const msg::PlantState&, const LiveRun&)> say;
  const char* told = kWritesOn;  // in the event of the run that names it
  bool asks = false;             // it says what operators say, which with --open anybody may
  bool bites = true;             // on a run whose key the attacker has
};

[[nodiscard]] std::span<const Attack> attacks();

}  // namespace baton::test
