/// Who belongs to a run. Its processes share a key, and the GUID prefix of each participant that they make carries a
/// mark that only the key gives: from any sample they can tell one of their own before they look into it, and nothing
/// else has to be agreed upon. Whoever merely reads the traffic cannot make such a prefix. One that was seen can be
/// copied into forged RTPS; against that only DDS Security helps.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "dds/types.hpp"

namespace baton::dds {

class RunKey {
 public:
  /// From the system's source of random numbers. Throws UnavailableError when it gives none.
  [[nodiscard]] static RunKey fresh();
  /// Back from text(); nothing for another text.
  [[nodiscard]] static std::optional<RunKey> parse(std::string_view text);
  /// 64 hexadecimal digits.
  [[nodiscard]] std::string text() const;

  /// A prefix for a new participant on the host of `prefix`: the first four bytes, which say vendor and host, stay;
  /// four are random, and the last four are HMAC-SHA256 of the others.
  [[nodiscard]] GuidPrefix marked(const GuidPrefix& prefix) const;
  [[nodiscard]] bool isMarked(const GuidPrefix& prefix) const;

  bool operator==(const RunKey&) const = default;

 private:
  using Bytes = std::array<std::uint8_t, 32>;
  explicit RunKey(const Bytes& bytes) : bytes_(bytes) {}
  [[nodiscard]] std::array<std::uint8_t, 4> markOf(const GuidPrefix& prefix) const;

  Bytes bytes_;
};

}  // namespace baton::dds
