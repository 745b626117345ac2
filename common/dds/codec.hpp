/// A message to its payload and back: 4-byte encapsulation header, then CDR. The only place that serialises.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "msg/cdr.hpp"

namespace baton::dds {

/// RTPS carries payloads in multiples of this; what is short is filled up with zeros.
inline constexpr std::size_t kPayloadAlignment = 4;

/// The largest payload a message of type T can have; encapsulation header and filling are counted.
template <class T>
[[nodiscard]] constexpr std::size_t maxPayload() {
  return msg::maxCdrSize<T>() + 4 + kPayloadAlignment;
}

/// Encodes into `buffer` (at least maxPayload<T>() bytes), whatever it held. Returns the payload, a view of the buffer;
/// empty when it does not fit, which for a message within its bounds cannot happen.
template <class T>
[[nodiscard]] std::span<const std::byte> encode(const T& message, std::span<std::byte> buffer) noexcept {
  try {
    // Members are aligned by skipping bytes: without this, what the buffer held before would go out in between.
    std::fill(buffer.begin(), buffer.end(), std::byte{0});
    msg::FastBuffer fast(reinterpret_cast<char*>(buffer.data()), buffer.size());
    msg::PlainCdr cdr(fast, msg::PlainCdr::LITTLE_ENDIANNESS);
    cdr.serialize_encapsulation();
    cdr << message;
    // Filled up here and not on the way, so that what is sent is what is received, hashed and recorded.
    std::size_t size = cdr.length();
    while (size % kPayloadAlignment != 0) {
      if (size == buffer.size()) return {};
      buffer[size++] = std::byte{0};
    }
    return buffer.first(size);
  } catch (const msg::CdrError&) {
    return {};
  }
}

/// Decodes a payload of either byte order. Returns false, leaving the message in some valid state, when the payload is
/// not one of type T.
template <class T>
[[nodiscard]] bool decode(std::span<const std::byte> payload, T& message) noexcept {
  // Plain CDR is 0 and 1; Fast CDR 2 would change to what another header says.
  if (payload.size() < 2 || payload[0] != std::byte{0} || payload[1] > std::byte{1}) return false;
  try {
    // FastBuffer is not const-correct; deserialising does not write.
    msg::FastBuffer fast(const_cast<char*>(reinterpret_cast<const char*>(payload.data())), payload.size());
    msg::PlainCdr cdr(fast);
    cdr.read_encapsulation();
    cdr >> message;
    return true;
  } catch (...) {  // bad_alloc from a length that cannot be, too
    return false;
  }
}

}  // namespace baton::dds
