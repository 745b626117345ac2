/// Plain types at the border of the DDS layer. Nothing outside common/dds names the DDS product.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace baton::dds {

/// RTPS GUID: the first 12 bytes name the participant, the last 4 the entity.
struct Guid {
  std::array<std::uint8_t, 16> bytes{};
  auto operator<=>(const Guid&) const = default;
};

/// The participant part of a GUID.
using GuidPrefix = std::array<std::uint8_t, 12>;
[[nodiscard]] GuidPrefix prefixOf(const Guid& guid);

/// Two digits a byte, and back; false for another text, of which nothing is to be used then.
[[nodiscard]] std::string toHex(std::span<const std::uint8_t> bytes);
[[nodiscard]] bool fromHex(std::string_view text, std::span<std::uint8_t> bytes);

/// "0123456789abcdef01234567".
[[nodiscard]] std::string toString(const GuidPrefix& prefix);
/// "0123456789abcdef01234567.00000103", as DDS tools print it.
[[nodiscard]] std::string toString(const Guid& guid);
/// Back from that; nothing for another text.
[[nodiscard]] std::optional<Guid> guidCalled(std::string_view text);

/// A received sample: the serialized payload, 4-byte encapsulation header included, and what DDS says of it. The span
/// lives as long as the callback.
struct RawSample {
  std::span<const std::byte> payload;
  std::uint64_t sequence = 0;            // of its writer, from 1
  std::int64_t source_timestamp_ns = 0;  // set by the writer
  std::int64_t reception_timestamp_ns = 0;
  Guid writer;
  bool has_data =
      true;  // false: an instance of a keyed topic has been disposed of or left; of value is the number alone
};

/// How a topic behaves; qos.cpp gives each its reasons.
enum class Profile {
  kLoop,     // samples of the control loop
  kRequest,  // something asked or answered once, by somebody who leaves soon after
  kStatus,   // the latest word of each writer, for late joiners too
  kEvent     // everything that was decided, for late joiners too
};

enum class Transport {
  kUdp,          // loopback UDP: survives any kill, the default
  kSharedMemory  // faster, but kill -9 leaves files behind and delays the next start
};
/// "udp", "shm", and back; nothing for another word.
[[nodiscard]] const char* toString(Transport transport);
[[nodiscard]] std::optional<Transport> transportCalled(const std::string& name);

}  // namespace baton::dds
