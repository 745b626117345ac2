/// Little-endian numbers, strings and maps in and out of bytes, as MCAP serialises them. Every length read is checked
/// against the bytes that are left before it is believed.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mcap/error.hpp"

namespace baton::mcap {

static_assert(std::endian::native == std::endian::little, "MCAP numbers are copied as they lie in memory");

using Bytes = std::vector<std::byte>;
using ByteView = std::span<const std::byte>;

[[nodiscard]] inline std::string_view asText(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[nodiscard]] inline ByteView asBytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// Storage that is reused and not cleared: a size claimed by a damaged file costs address space, not memory.
class Buffer {
 public:
  /// n bytes, not initialised; what was there before is gone.
  [[nodiscard]] std::span<std::byte> resize(std::size_t n) {
    if (n > capacity_) {
      data_ = std::make_unique_for_overwrite<std::byte[]>(n);
      capacity_ = n;
    }
    return {data_.get(), n};
  }

 private:
  std::unique_ptr<std::byte[]> data_;
  std::size_t capacity_ = 0;
};

/// Takes fields off the front of a view. Throws FormatError when the view is too short.
class ByteReader {
 public:
  explicit ByteReader(ByteView bytes) : rest_(bytes), size_(bytes.size()) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] ByteView rest() const { return rest_; }
  /// Bytes taken so far.
  [[nodiscard]] std::size_t position() const { return size_ - rest_.size(); }

  template <std::unsigned_integral Number>
  [[nodiscard]] Number number() {
    Number value;
    std::memcpy(&value, bytes(sizeof(Number)).data(), sizeof(Number));
    return value;
  }

  [[nodiscard]] ByteView bytes(std::uint64_t n) {
    if (n > rest_.size()) {
      throw FormatError("a field needs " + std::to_string(n) + " bytes where " + std::to_string(rest_.size()) +
                        " are left");
    }
    const ByteView taken = rest_.first(static_cast<std::size_t>(n));
    rest_ = rest_.subspan(static_cast<std::size_t>(n));
    return taken;
  }

  /// Bytes behind their u32 length: strings, arrays and maps begin so.
  [[nodiscard]] ByteView sized() { return bytes(number<std::uint32_t>()); }

  [[nodiscard]] std::string string() {
    const ByteView text = sized();
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }

 private:
  ByteView rest_;
  std::size_t size_;
};

inline void append(Bytes& out, ByteView bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); }

template <std::unsigned_integral Number>
void appendNumber(Bytes& out, Number value) {
  append(out, std::as_bytes(std::span(&value, 1)));
}

/// Bytes behind their u32 length. Throws UsageError above 4 GiB, which MCAP cannot express.
inline void appendSized(Bytes& out, ByteView bytes) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw UsageError("an MCAP field holds at most 4294967295 bytes, this one has " + std::to_string(bytes.size()));
  }
  appendNumber(out, static_cast<std::uint32_t>(bytes.size()));
  append(out, bytes);
}

}  // namespace baton::mcap
