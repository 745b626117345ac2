#include "dds/run_key.hpp"

#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <algorithm>
#include <span>

#include "base/error.hpp"

namespace baton::dds {
namespace {

constexpr std::size_t kRandomAt = 4, kMarkAt = 8;  // in a prefix
constexpr std::size_t kMarkSize = 4;
static_assert(kMarkAt + kMarkSize == sizeof(GuidPrefix) && kRoles * kMarkSize == 32,
              "each role has its part of a digest");

void fillRandomly(std::span<std::uint8_t> bytes) {
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw UnavailableError("the system gives no random numbers, of which a run's key is made");
  }
}

}  // namespace

RunKey RunKey::fresh() {
  Bytes bytes{};
  fillRandomly(bytes);
  return RunKey(bytes);
}

std::optional<RunKey> RunKey::parse(std::string_view text) {
  Bytes bytes{};
  return fromHex(text, bytes) ? std::optional(RunKey(bytes)) : std::nullopt;
}

std::string RunKey::text() const { return toHex(bytes_); }

GuidPrefix RunKey::marked(const GuidPrefix& prefix, Role role) const {
  GuidPrefix result = prefix;
  fillRandomly(std::span(result).subspan(kRandomAt, kMarkAt - kRandomAt));
  std::copy_n(marksOf(result).begin() + kMarkSize * static_cast<std::size_t>(role), kMarkSize,
              result.begin() + kMarkAt);
  return result;
}

std::optional<Role> RunKey::roleOf(const GuidPrefix& prefix) const {
  const Bytes marks = marksOf(prefix);
  for (std::size_t role = 0; role < kRoles; ++role) {
    if (std::equal(prefix.begin() + kMarkAt, prefix.end(), marks.begin() + kMarkSize * role)) {
      return static_cast<Role>(role);
    }
  }
  return std::nullopt;
}

std::string RunKey::proofOf(const GuidPrefix& prefix, std::string_view text) const {
  const Bytes digest = digestOf(std::string(prefix.begin(), prefix.end()).append(text));
  return toHex(std::span(digest).first(digest.size() / 2));
}

RunKey::Bytes RunKey::digestOf(std::string_view text) const {
  Bytes digest{};
  HMAC(EVP_sha256(), bytes_.data(), static_cast<int>(bytes_.size()),
       reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data(), nullptr);
  return digest;
}

RunKey::Bytes RunKey::marksOf(const GuidPrefix& prefix) const {
  return digestOf(std::string(prefix.begin(), prefix.begin() + kMarkAt));
}

}  // namespace baton::dds
