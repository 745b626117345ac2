/// A run whose baton goes round: how long each handover takes, from its being asked for to the step of the new holder.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "programs.hpp"

namespace baton::bench {

struct SwapCase {
  std::string name;  // for --only, and in the JSON
  bool is_realtime = false;
};

/// In real time at 1 kHz, and as the scenario `lab` has it: in lockstep, paced to the clock.
[[nodiscard]] const std::vector<SwapCase>& allSwapCases();

struct Handovers {
  double step_s = 0.0;
  std::uint64_t margin_steps = 0;
  // Of each one that took place. The clock is the machine's, the times are those at which samples were sent.
  std::vector<double> asked_to_effect_ms;  // from the request to the state that names the new holder
  std::vector<std::uint64_t> steps;        // from the step that was open when the plant decided to that state's
  std::uint64_t refused = 0;
  std::string refusal;     // the first one's reason
  std::uint64_t lost = 0;  // how often a holder lost the baton: it was too slow for real time
  nlohmann::json timing;   // of the run's result: handover_us is the plant's own count, from its plan to that state
};

/// Runs the scenario `lab`, with all its parts and its recorder, and asks `swaps` times for a handover to the next of
/// its controllers, each once the blend of the one before is over and at no particular time of a step. Throws
/// UnavailableError when the run fails or nobody answers.
[[nodiscard]] Handovers measureHandovers(const SwapCase& one, int swaps, const std::vector<std::string>& scheduling,
                                         Programs& programs);

}  // namespace baton::bench
