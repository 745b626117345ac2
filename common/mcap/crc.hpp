/// CRC-32 (IEEE 802.3, as in zlib), which MCAP uses for chunks, attachments, the data section and the summary.
#pragma once

#include <cstdint>

#include "mcap/bytes.hpp"

namespace baton::mcap {

/// The CRC of `bytes`, or of what `crc` covers followed by `bytes`.
[[nodiscard]] std::uint32_t crc32(ByteView bytes, std::uint32_t crc = 0);

/// The CRC of two stretches in a row from their CRCs, without reading the second one again.
[[nodiscard]] std::uint32_t crc32Joined(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

}  // namespace baton::mcap
