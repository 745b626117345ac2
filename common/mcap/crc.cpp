#include "mcap/crc.hpp"

#include <zlib.h>

namespace baton::mcap {

std::uint32_t crc32(ByteView bytes, std::uint32_t crc) {
  if (bytes.empty()) return crc;  // zlib reads a null pointer as "start again"
  return static_cast<std::uint32_t>(::crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint32_t crc32Joined(std::uint32_t first, std::uint32_t second, std::uint64_t second_size) {
  return static_cast<std::uint32_t>(::crc32_combine(first, second, static_cast<z_off_t>(second_size)));
}

}  // namespace baton::mcap
