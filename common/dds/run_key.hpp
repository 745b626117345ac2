/// Who belongs to a run, and as what. Its processes share a key, and the GUID prefix of each participant that they make
/// carries a mark that only the key gives, another one for each role: from any sample they can tell one of their own,
/// and what it may say, before they look into it, and nothing else has to be agreed upon. Whoever merely reads the
/// traffic cannot make such a prefix. One that was seen can be copied; see Participant::roleOf for what that gives.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "dds/roles.hpp"
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
  /// four are random, and the last four are the role's part of HMAC-SHA256 of the others: bytes 4 r to 4 r + 3 for the
  /// role of number r.
  [[nodiscard]] GuidPrefix marked(const GuidPrefix& prefix, Role role) const;
  /// The role that a prefix was marked for; nothing when it bears no mark of this key.
  [[nodiscard]] std::optional<Role> roleOf(const GuidPrefix& prefix) const;
  /// What a participant says of itself, signed: 32 hexadecimal digits, the first half of HMAC-SHA256 of its prefix and
  /// the text.
  [[nodiscard]] std::string proofOf(const GuidPrefix& prefix, std::string_view text) const;

  bool operator==(const RunKey&) const = default;

 private:
  using Bytes = std::array<std::uint8_t, 32>;
  explicit RunKey(const Bytes& bytes) : bytes_(bytes) {}
  /// HMAC-SHA256.
  [[nodiscard]] Bytes digestOf(std::string_view text) const;
  [[nodiscard]] Bytes marksOf(const GuidPrefix& prefix) const;

  Bytes bytes_;
};

}  // namespace baton::dds
