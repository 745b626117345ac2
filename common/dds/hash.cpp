#include "dds/hash.hpp"

#include <xxhash.h>

namespace baton::dds {

std::uint64_t chainHash(std::uint64_t so_far, std::span<const std::byte> payload) noexcept {
  return XXH3_64bits_withSeed(payload.data(), payload.size(), so_far);
}

}  // namespace baton::dds
