#include "dds/types.hpp"

#include <algorithm>
#include <charconv>

namespace baton::dds {

GuidPrefix prefixOf(const Guid& guid) {
  GuidPrefix prefix;
  std::copy_n(guid.bytes.begin(), prefix.size(), prefix.begin());
  return prefix;
}

std::string toHex(std::span<const std::uint8_t> bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 0xF];
  }
  return text;
}

bool fromHex(std::string_view text, std::span<std::uint8_t> bytes) {
  if (text.size() != 2 * bytes.size()) return false;
  for (std::uint8_t& byte : bytes) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + 2, byte, 16);
    if (error != std::errc() || end != text.data() + 2) return false;
    text.remove_prefix(2);
  }
  return true;
}

std::string toString(const GuidPrefix& prefix) { return toHex(prefix); }

std::string toString(const Guid& guid) {
  const std::span<const std::uint8_t> bytes(guid.bytes);
  constexpr std::size_t kPrefix = std::tuple_size_v<GuidPrefix>;
  return toHex(bytes.first(kPrefix)) + "." + toHex(bytes.subspan(kPrefix));
}

std::optional<Guid> guidCalled(std::string_view text) {
  constexpr std::size_t kPrefix = std::tuple_size_v<GuidPrefix>, kDot = 2 * kPrefix;
  if (text.size() <= kDot || text[kDot] != '.') return std::nullopt;
  Guid guid;
  const std::span<std::uint8_t> bytes(guid.bytes);
  const bool is_guid =
      fromHex(text.substr(0, kDot), bytes.first(kPrefix)) && fromHex(text.substr(kDot + 1), bytes.subspan(kPrefix));
  return is_guid ? std::optional(guid) : std::nullopt;
}

const char* toString(Transport transport) { return transport == Transport::kSharedMemory ? "shm" : "udp"; }

std::optional<Transport> transportCalled(const std::string& name) {
  for (const Transport transport : {Transport::kUdp, Transport::kSharedMemory}) {
    if (name == toString(transport)) return transport;
  }
  return std::nullopt;
}

}  // namespace baton::dds
