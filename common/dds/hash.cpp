#include "dds/hash.hpp"

#include <xxhash.h>

#include <array>

namespace baton::dds {

std::uint64_t chainHash(std::uint64_t so_far, std::span<const std::byte> payload) noexcept {
  return XXH3_64bits_withSeed(payload.data(), payload.size(), so_far);
}

std::uint64_t chainStep(std::uint64_t so_far, const StepHashes& step) noexcept {
  const std::array<std::uint64_t, 4> hashes{step.state, step.contact, step.outgoing_command, step.command};
  return chainHash(so_far, std::as_bytes(std::span(hashes)));
}

std::uint64_t inputsHash(std::span<const std::uint64_t> payload_hashes) noexcept {
  return chainHash(0, std::as_bytes(payload_hashes));
}

}  // namespace baton::dds
