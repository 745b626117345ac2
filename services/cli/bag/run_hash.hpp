/// `baton bag hash`: the hash of a run, computed again from the recorded payloads of its loop, and compared.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "dds/hash.hpp"
#include "mcap/joined_reader.hpp"

namespace baton {

/// A recorded loop, as hashes; of a run that was reset, its last take.
struct HashedRun {
  struct Step {
    dds::StepHashes hashes;  // of what was recorded for the step; 0 for what was not
    std::uint64_t reference = 0;
    std::uint64_t chain = 0;  // PlantState.chain_hash: of the steps before
    std::string holder;
  };
  std::map<std::uint64_t, Step> steps;  // those with a PlantState

  /// What the last state says: of everything before it.
  [[nodiscard]] std::uint64_t hash() const;
  /// The first step whose recorded payloads do not give the hash that the next state carries; nothing when all do. A
  /// step may have done without a payload that came too late for it (realtime, or a holder that failed).
  [[nodiscard]] std::optional<std::uint64_t> firstBroken() const;
};

/// Throws UsageError when the file has no states, and what reading a recording throws.
[[nodiscard]] HashedRun hashRun(const mcap::FileList& file);
/// Of a recording that is open. @param file  its files, for messages.
[[nodiscard]] HashedRun hashRun(const mcap::JoinedReader& reader, const mcap::FileList& file);

/// Where two runs part: the first payload that differs. One that only one of the two has is no difference by itself: a
/// process may have died before it sent it, and the next state says whether the plant used it.
struct Parting {
  std::uint64_t step = 0;
  std::string topic;  // "plant_state", "contact", "reference" or "joint_command"
};
struct Comparison {
  std::uint64_t steps = 0;  // that both have
  std::optional<Parting> parting;
};
[[nodiscard]] Comparison compare(const HashedRun& a, const HashedRun& b);

}  // namespace baton
