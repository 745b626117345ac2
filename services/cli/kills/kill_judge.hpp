/// Whether a run went on, or ended, as its scenario has it after one of its processes was killed; by what is recorded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kills/kill_run.hpp"

namespace baton {

/// The plant's word on a run, step by step.
struct PlantRecord {
  std::vector<std::string> holders;      // by step
  std::optional<std::uint64_t> lost_at;  // when the victim was taken for failed
  double largest_torque = 0.0;           // of any joint, in parts of its limit; infinite when one is not finite
};
[[nodiscard]] PlantRecord readPlantRecord(const std::filesystem::path& recording, const Scenario& scenario,
                                          const std::string& victim);

/// Why it did not; empty when it did.
/// @param undisturbed_hash  of the same scenario without a kill.
[[nodiscard]] std::string objectionTo(const Kill& kill, const KilledRun& run, const PlantRecord& record,
                                      const Scenario& scenario, const std::string& undisturbed_hash);

}  // namespace baton
