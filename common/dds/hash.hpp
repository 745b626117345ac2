/// The one hash of payloads: XXH3, chained by seeding each with the hash before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace baton::dds {

/// Hash of everything hashed so far followed by `payload`; start with 0.
[[nodiscard]] std::uint64_t chainHash(std::uint64_t so_far, std::span<const std::byte> payload) noexcept;

}  // namespace baton::dds
