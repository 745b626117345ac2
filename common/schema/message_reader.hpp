/// Walks through a payload along its type, one item after another: nothing is stored and nothing recurses, so a message
/// costs what its bytes cost.
///
///   schema::MessageReader message(type, payload);
///   for (schema::Item item; message.next(item);) use(item);
///
/// Payloads are plain CDR (XCDR1) of either byte order, behind the 4-byte encapsulation header; final and appendable
/// types are alike in it. XCDR2, in which appendable ones are delimited, and parameter lists are refused by name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "schema/limits.hpp"
#include "schema/type.hpp"

namespace baton::schema {

using Bytes = std::span<const std::byte>;

/// Signed integers and enums are int64_t, unsigned ones, a wide character and a single octet uint64_t, chars and
/// strings text as it lies in the payload (whatever its encoding), sequences and arrays of octets bytes.
using Value = std::variant<bool, std::int64_t, std::uint64_t, float, double, std::string_view, Bytes>;

struct Item {
  enum class What { kBegin, kEnd, kValue };  // begin and end of a struct, union, sequence or array
  What what = What::kEnd;
  const Type* type = nullptr;
  const Member* member = nullptr;  // of the struct or union around it; null for an element and for the whole message
  std::uint32_t index = 0;         // among its parent's, those that are there; kEnd: how many there were within
  std::uint32_t count = 0;         // kBegin of a sequence or array: its elements
  Value value{};                   // kValue; valid as long as the payload
};

class MessageReader {
 public:
  /// @param type  outlives the reader.
  /// Throws PayloadError when the payload does not begin with an encapsulation header that is understood.
  MessageReader(const Type& type, Bytes payload);

  /// The next item; false behind the last one. Throws PayloadError for what no message of the type can be: lengths
  /// beyond the bytes that are left or beyond a bound, a boolean that is neither 0 nor 1, a string without its end,
  /// more than the 3 bytes behind the message that fill up a payload; and for more than kMaxEmpty empty structs.
  [[nodiscard]] bool next(Item& item);

  /// Where the last item is: "tip_position[2]"; empty for the whole message.
  [[nodiscard]] std::string path() const;

 private:
  struct Level {
    const Type* type = nullptr;
    const Member* chosen = nullptr;  // of a union, once its discriminator was read
    std::uint32_t next = 0;          // child
    std::uint32_t count = 0;         // of children
  };

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const;
  [[nodiscard]] Bytes take(std::uint64_t count);
  template <class Number>
  [[nodiscard]] Number number();
  [[nodiscard]] std::uint32_t lengthOf(const Type& type);
  [[nodiscard]] std::string_view string(const Type& type);
  [[nodiscard]] Value valueOf(const Type& type);
  void read(Item& item, Level* parent);
  void end(Item& item);

  const Type& type_;
  Bytes body_;  // behind the header; alignment counts from its begin
  std::size_t position_ = 0;
  bool is_little_endian_ = true;
  std::array<Level, kMaxDepth> levels_{};
  std::size_t depth_ = 0;
  std::uint32_t empty_ = 0;  // structs without members so far
  bool has_begun_ = false;
};

}  // namespace baton::schema
