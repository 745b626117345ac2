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

GuidPrefix RunKey::marked(const GuidPrefix& prefix) const {
  GuidPrefix result = prefix;
  fillRandomly(std::span(result).subspan(kRandomAt, kMarkAt - kRandomAt));
  std::ranges::copy(markOf(result), result.begin() + kMarkAt);
  return result;
}

bool RunKey::isMarked(const GuidPrefix& prefix) const {
  return std::ranges::equal(markOf(prefix), std::span(prefix).subspan(kMarkAt));
}

std::array<std::uint8_t, 4> RunKey::markOf(const GuidPrefix& prefix) const {
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest{};
  HMAC(EVP_sha256(), bytes_.data(), static_cast<int>(bytes_.size()), prefix.data(), kMarkAt, digest.data(), nullptr);
  std::array<std::uint8_t, 4> mark{};
  std::copy_n(digest.begin(), mark.size(), mark.begin());
  return mark;
}

}  // namespace baton::dds
