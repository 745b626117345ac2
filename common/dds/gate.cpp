#include "dds/gate.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

namespace baton::dds {
namespace {

// RTPS 2.5, 8.3 and 9.4: a header of 20 bytes, then submessages.
constexpr std::size_t kPrefixAt = 8, kHeader = 20, kSubmessageHeader = 4;
constexpr std::uint8_t kPad = 0x01, kAckNack = 0x06, kInfoTimestamp = 0x09, kInfoDestination = 0x0e, kNackFrag = 0x12,
                       kOfVendors = 0x80;

std::uint8_t byteAt(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}

std::uint32_t numberAt(std::span<const std::byte> bytes, std::size_t at, std::size_t size, bool is_little) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < size; ++i) {
    number = number << 8 | byteAt(bytes, at + (is_little ? size - 1 - i : i));
  }
  return number;
}

/// Of an acknowledgement: reader, writer, and from where on which samples are missing, by their bits. Nothing of one
/// that is not whole.
std::optional<std::int64_t> asksOf(std::span<const std::byte> body, bool is_little) {
  constexpr std::size_t kBitsAt = 16, kMapAt = 20, kMostBits = 256, kCount = 4;
  if (body.size() < kMapAt) return std::nullopt;
  const std::size_t bits = numberAt(body, kBitsAt, 4, is_little), map = (bits + 31) / 32 * 4;
  if (bits > kMostBits || body.size() < kMapAt + map + kCount) return std::nullopt;
  std::int64_t asks = 1;
  for (std::size_t at = kMapAt; at < kMapAt + map; ++at) asks += std::popcount(byteAt(body, at));
  return asks;
}

/// How much a message asks for; nothing for one that does more than to ask.
std::optional<std::int64_t> asksIn(std::span<const std::byte> message) {
  std::int64_t asks = 0;
  for (std::span<const std::byte> rest = message.subspan(kHeader); rest.size() >= kSubmessageHeader;) {
    const std::uint8_t kind = byteAt(rest, 0);
    const bool is_little = (byteAt(rest, 1) & 1) != 0;
    const std::size_t said = numberAt(rest, 2, 2, is_little);
    rest = rest.subspan(kSubmessageHeader);
    // A submessage of length 0 is the last one and reaches to the end; any other ends on a multiple of four, or DDS
    // and we would not see the same ones behind it.
    const bool is_last = said == 0 && kind != kPad && kind != kInfoTimestamp;
    if (said > rest.size() || said % 4 != 0) return std::nullopt;
    const auto body = rest.first(is_last ? rest.size() : said);
    if (kind >= kOfVendors) {  // nothing that Fast DDS looks at: it adds statistics of its own to what it sends
      rest = rest.subspan(body.size());
      continue;
    }
    switch (kind) {
      case kPad:
      case kInfoTimestamp:
      case kInfoDestination: break;
      case kAckNack: {
        const std::optional<std::int64_t> more = asksOf(body, is_little);
        if (!more) return std::nullopt;
        asks += *more;
        break;
      }
      case kNackFrag: asks += 256; break;  // so many fragments at most
      default: return std::nullopt;
    }
    rest = rest.subspan(body.size());
  }
  return asks;
}

}  // namespace

Gate::Gate(const RunKey& key, Strangers strangers, Tell tell)
    : key_(key), strangers_(strangers), tell_(std::move(tell)) {}

bool Gate::admits(std::span<const std::byte> message, std::int64_t now_ns) {
  if (strangers_ == Strangers::kSpeakFreely) return true;
  GuidPrefix sender{};
  constexpr std::array kMagic{std::byte{'R'}, std::byte{'T'}, std::byte{'P'}, std::byte{'S'}};
  if (message.size() < kHeader || !std::ranges::equal(message.first(kMagic.size()), kMagic)) {
    const std::lock_guard lock(mutex_);
    ++turned_away_;  // nobody's
    return false;
  }
  std::transform(message.begin() + kPrefixAt, message.begin() + kHeader, sender.begin(),
                 [](std::byte one) { return std::to_integer<std::uint8_t>(one); });
  if (isMember(sender)) return true;
  const std::optional<std::int64_t> asks = asksIn(message);
  if (asks && (strangers_ == Strangers::kAskFreely || mayAsk(*asks, now_ns))) return true;
  turnAway(sender, asks ? Trespass::kAsksTooMuch : Trespass::kSpeaks);
  return false;
}

std::uint64_t Gate::turnedAway() const {
  const std::lock_guard lock(mutex_);
  return turned_away_;
}

bool Gate::isMember(const GuidPrefix& sender) {
  {
    const std::lock_guard lock(mutex_);
    if (members_.contains(sender)) return true;
  }
  if (!key_.roleOf(sender)) return false;
  const std::lock_guard lock(mutex_);
  members_.insert(sender);
  return true;
}

bool Gate::mayAsk(std::int64_t asks, std::int64_t now_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::lock_guard lock(mutex_);
  const std::int64_t passed_ns = std::clamp<std::int64_t>(now_ns - counted_at_ns_, 0, kSecond_ns);
  const std::int64_t more = passed_ns * kAsksPerSecond / kSecond_ns;
  if (more > 0) {  // else what is less than one would be lost
    asks_left_ = std::min(kAsksPerSecond, asks_left_ + more);
    counted_at_ns_ = now_ns;
  }
  if (asks > asks_left_) return false;
  asks_left_ -= asks;
  return true;
}

void Gate::turnAway(const GuidPrefix& sender, Trespass what) {
  {
    const std::lock_guard lock(mutex_);
    ++turned_away_;
    if (told_.size() >= kMostTold || !told_.emplace(sender, what).second) return;
  }
  if (tell_) tell_(sender, what);
}

}  // namespace baton::dds
