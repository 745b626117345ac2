/// A message to its payload and back: 4-byte encapsulation header, then CDR. The only place that serialises.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace baton::dds {

/// RTPS carries payloads in multiples of this; what is short is filled up with zeros.
inline constexpr std::size_t kPayloadAlignment = 4;

/// The largest payload a message of type T can have; encapsulation header and filling are counted.
template <class T>
[[nodiscard]] constexpr std::size_t maxPayload() {
  return T::getMaxCdrSerializedSize() + 4 + kPayloadAlignment;
}

/// Encodes into `buffer` (at least maxPayload<T>() bytes), whatever it held. Returns the payload, a view of the buffer;
/// empty when it does not fit, which for a message within its bounds cannot happen.
template <class T>
[[nodiscard]] std::span<const std::byte> encode(const T& message, std::span<std::byte> buffer) noexcept {
  using eprosima::fastcdr::Cdr;
  try {
    // Members are aligned by skipping bytes: without this, what the buffer held before would go out in between.
    std::fill(buffer.begin(), buffer.end(), std::byte{0});
    eprosima::fastcdr::FastBuffer fast(reinterpret_cast<char*>(buffer.data()), buffer.size());
    Cdr cdr(fast, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
    cdr.serialize_encapsulation();
    message.serialize(cdr);
    // Filled up here and not on the way, so that what is sent is what is received, hashed and recorded.
    std::size_t size = cdr.getSerializedDataLength();
    while (size % kPayloadAlignment != 0) {
      if (size == buffer.size()) return {};
      buffer[size++] = std::byte{0};
    }
    return buffer.first(size);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return {};
  }
}

/// Decodes a payload of either byte order. Returns false, leaving the message in some valid state, when the payload is
/// not one of type T.
template <class T>
[[nodiscard]] bool decode(std::span<const std::byte> payload, T& message) noexcept {
  using eprosima::fastcdr::Cdr;
  try {
    // FastBuffer is not const-correct; deserialising does not write.
    eprosima::fastcdr::FastBuffer fast(const_cast<char*>(reinterpret_cast<const char*>(payload.data())),
                                       payload.size());
    Cdr cdr(fast, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    message.deserialize(cdr);
    return true;
  } catch (...) {  // bad_alloc from a length that cannot be, too
    return false;
  }
}

}  // namespace baton::dds
