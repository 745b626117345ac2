#include "dds/types.hpp"

#include <algorithm>
#include <charconv>

namespace baton::dds {

GuidPrefix prefixOf(const Guid& guid) {
  GuidPrefix prefix;
  std::copy_n(guid.bytes.begin(), prefix.size(), prefix.begin());
  return prefix;
}

namespace {
std::string digitsOf(std::span<const std::uint8_t> bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 0xF];
  }
  return text;
}
}  // namespace

std::string toString(const GuidPrefix& prefix) { return digitsOf(prefix); }

std::string toString(const Guid& guid) {
  const std::span<const std::uint8_t> bytes(guid.bytes);
  constexpr std::size_t kPrefix = std::tuple_size_v<GuidPrefix>;
  return digitsOf(bytes.first(kPrefix)) + "." + digitsOf(bytes.subspan(kPrefix));
}

std::optional<Guid> guidCalled(std::string_view text) {
  constexpr std::size_t kDot = 2 * std::tuple_size_v<GuidPrefix>;
  Guid guid;
  if (text.size() != 2 * guid.bytes.size() + 1 || text[kDot] != '.') return std::nullopt;
  for (std::size_t i = 0; i < guid.bytes.size(); ++i) {
    const char* digits = text.data() + 2 * i + (2 * i < kDot ? 0 : 1);
    const auto [end, error] = std::from_chars(digits, digits + 2, guid.bytes[i], 16);
    if (error != std::errc() || end != digits + 2) return std::nullopt;
  }
  return guid;
}

const char* toString(Transport transport) { return transport == Transport::kSharedMemory ? "shm" : "udp"; }

std::optional<Transport> transportCalled(const std::string& name) {
  for (const Transport transport : {Transport::kUdp, Transport::kSharedMemory}) {
    if (name == toString(transport)) return transport;
  }
  return std::nullopt;
}

}  // namespace baton::dds
