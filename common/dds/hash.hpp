/// The one hash of payloads: XXH3, chained by seeding each with the hash before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace baton::dds {

/// Hash of everything hashed so far followed by `payload`; start with 0.
[[nodiscard]] std::uint64_t chainHash(std::uint64_t so_far, std::span<const std::byte> payload) noexcept;

/// Hashes of the payloads that decide a step, each chainHash(0, payload); 0 for one that there is not.
struct StepHashes {
  std::uint64_t state = 0;
  std::uint64_t contact = 0;
  std::uint64_t outgoing_command = 0;  // at the first step of a new holder
  std::uint64_t command = 0;
};

/// PlantState.chain_hash of the step after: of the run so far followed by this step.
[[nodiscard]] std::uint64_t chainStep(std::uint64_t so_far, const StepHashes& step) noexcept;

/// JointCommand.inputs_hash: of the hashes of the payloads it was computed from, in the order state, reference,
/// contact.
[[nodiscard]] std::uint64_t inputsHash(std::span<const std::uint64_t> payload_hashes) noexcept;

}  // namespace baton::dds
