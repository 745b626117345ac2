#include "schema/message_reader.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "schema/error.hpp"

namespace baton::schema {
namespace {

constexpr std::size_t kHeader = 4;
constexpr std::size_t kMostFilling = 3;  // RTPS carries multiples of four bytes

/// What stands where plain CDR was expected, by the two bytes of an encapsulation header (RTPS 2.5, 10.5).
std::string encodingName(unsigned encoding) {
  switch (encoding) {
    case 2:
    case 3: return "a parameter list, as of a mutable type";
    case 4: return "XML";
    case 6:
    case 7: return "XCDR2";
    case 8:
    case 9: return "XCDR2, delimited, as of an appendable type";
    case 10:
    case 11: return "XCDR2, a parameter list, as of a mutable type";
    default: return "which no standard names";
  }
}

bool isPlain(Kind kind) { return kind <= Kind::kEnum; }

/// Opaque bytes come whole.
bool isBytes(const Type& type) {
  return (type.kind == Kind::kSequence || type.kind == Kind::kArray) && type.element->kind == Kind::kOctet;
}

/// What a union's labels are compared with; of a character its code.
std::int64_t labelOf(const Value& discriminator) {
  if (const auto* flag = std::get_if<bool>(&discriminator)) return static_cast<std::int64_t>(*flag);
  if (const auto* natural = std::get_if<std::uint64_t>(&discriminator)) return static_cast<std::int64_t>(*natural);
  if (const auto* text = std::get_if<std::string_view>(&discriminator))
    return static_cast<unsigned char>(text->front());
  return std::get<std::int64_t>(discriminator);
}

template <class Number>
Number reversed(Number value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(Number)>>(value);
  std::ranges::reverse(bytes);
  return std::bit_cast<Number>(bytes);
}

}  // namespace

MessageReader::MessageReader(const Type& type, Bytes payload) : type_(type) {
  if (payload.size() < kHeader) {
    throw PayloadError("expected a header of 4 bytes, found " + std::to_string(payload.size()) + " bytes");
  }
  const auto encoding = static_cast<unsigned>(payload[0]) << 8 | static_cast<unsigned>(payload[1]);
  if (encoding > 1) {
    throw PayloadError("expected plain CDR (encoding 0 or 1), found encoding " + std::to_string(encoding) + ", " +
                       encodingName(encoding) + ", which is not supported");
  }
  is_little_endian_ = encoding == 1;
  body_ = payload.subspan(kHeader);
}

void MessageReader::fail(const std::string& expected, const std::string& found) const {
  const std::string place = path();
  throw PayloadError((place.empty() ? "" : place + ": ") + "expected " + expected + ", found " + found);
}

Bytes MessageReader::take(std::uint64_t count) {
  const std::size_t left = body_.size() - position_;
  if (count > left) fail(std::to_string(count) + " bytes", std::to_string(left));
  const Bytes taken = body_.subspan(position_, static_cast<std::size_t>(count));
  position_ += taken.size();
  return taken;
}

template <class Number>
Number MessageReader::number() {
  (void)take((sizeof(Number) - position_ % sizeof(Number)) % sizeof(Number));
  Number value;
  std::memcpy(&value, take(sizeof(Number)).data(), sizeof(Number));
  return is_little_endian_ == (std::endian::native == std::endian::little) ? value : reversed(value);
}

std::uint32_t MessageReader::lengthOf(const Type& type) {
  const auto length = number<std::uint32_t>();
  // A string's length counts the zero behind it.
  const std::uint64_t most = type.bound + (type.kind == Kind::kString ? 1 : 0);
  if (type.bound != 0 && length > most) fail("a length of at most " + std::to_string(most), std::to_string(length));
  const std::uint64_t least = std::uint64_t{length} * (type.kind == Kind::kString ? 1 : type.element->least_bytes);
  const std::size_t left = body_.size() - position_;
  if (least > left) fail("a length that fits into " + std::to_string(left) + " bytes", std::to_string(length));
  return length;
}

std::string_view MessageReader::string(const Type& type) {
  const std::uint32_t length = lengthOf(type);
  if (length == 0) return {};  // as some write an empty one
  const Bytes bytes = take(length);
  if (bytes.back() != std::byte{0})
    fail("a string that ends with a zero", std::to_string(static_cast<int>(bytes.back())));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size() - 1};
}

Value MessageReader::valueOf(const Type& type) {
  switch (type.kind) {
    case Kind::kBoolean: {
      const auto value = number<std::uint8_t>();
      if (value > 1) fail("a boolean, 0 or 1", std::to_string(value));
      return value == 1;
    }
    case Kind::kOctet:
    case Kind::kUint8: return std::uint64_t{number<std::uint8_t>()};
    case Kind::kInt8: return std::int64_t{number<std::int8_t>()};
    case Kind::kInt16: return std::int64_t{number<std::int16_t>()};
    case Kind::kWideChar:
    case Kind::kUint16: return std::uint64_t{number<std::uint16_t>()};
    case Kind::kInt32: return std::int64_t{number<std::int32_t>()};
    case Kind::kUint32: return std::uint64_t{number<std::uint32_t>()};
    case Kind::kInt64: return number<std::int64_t>();
    case Kind::kUint64: return number<std::uint64_t>();
    case Kind::kEnum: return std::int64_t{number<std::int32_t>()};
    case Kind::kFloat: return std::bit_cast<float>(number<std::uint32_t>());
    case Kind::kDouble: return std::bit_cast<double>(number<std::uint64_t>());
    case Kind::kChar: return std::string_view(reinterpret_cast<const char*>(take(1).data()), 1);
    case Kind::kString: return string(type);
    case Kind::kSequence: return take(lengthOf(type));
    default: return take(type.bound);  // an array of octets
  }
}

void MessageReader::read(Item& item, Level* parent) {
  const Type& type = *item.type;
  if (isPlain(type.kind) || isBytes(type)) {
    item.what = Item::What::kValue;
    item.value = valueOf(type);
    if (parent == nullptr || parent->type->kind != Kind::kUnion || item.index != 0) return;
    parent->chosen = chosenMember(*parent->type, labelOf(item.value));
    parent->count = parent->chosen == nullptr ? 1 : 2;
    return;
  }
  item.what = Item::What::kBegin;
  const bool is_empty = type.kind == Kind::kStruct && type.members.empty();
  if (is_empty && ++empty_ > kMaxEmpty)
    fail("at most " + std::to_string(kMaxEmpty) + " structs without members", "more");
  if (depth_ == levels_.size()) fail("at most " + std::to_string(kMaxDepth) + " values within each other", "more");
  Level level{.type = &type};
  switch (type.kind) {
    case Kind::kStruct: level.count = static_cast<std::uint32_t>(type.members.size()); break;
    case Kind::kUnion: level.count = 1; break;
    case Kind::kSequence: level.count = item.count = lengthOf(type); break;
    default: level.count = item.count = static_cast<std::uint32_t>(type.bound); break;
  }
  levels_.at(depth_++) = level;
}

void MessageReader::end(Item& item) {
  const Level& level = levels_.at(--depth_);
  item = {.what = Item::What::kEnd, .type = level.type, .index = level.count};
}

bool MessageReader::next(Item& item) {
  if (!has_begun_) {
    has_begun_ = true;
    item = {.type = &type_};
    read(item, nullptr);
    return true;
  }
  if (depth_ == 0) {
    const std::size_t left = body_.size() - position_;
    if (left > kMostFilling) fail("the end of the message", std::to_string(left) + " more bytes");
    return false;
  }
  Level& level = levels_.at(depth_ - 1);
  if (level.next == level.count) {
    end(item);
    return true;
  }
  const std::uint32_t index = level.next++;
  item = {.index = index};
  if (level.type->kind == Kind::kStruct) {
    item.member = &level.type->members[index];
  } else if (level.type->kind == Kind::kUnion) {
    item.member = index == 0 ? &level.type->members.front() : level.chosen;
  }
  item.type = item.member != nullptr ? item.member->type : level.type->element;
  read(item, &level);
  return true;
}

std::string MessageReader::path() const {
  std::string text;
  for (std::size_t i = 0; i < depth_; ++i) {
    const Level& level = levels_.at(i);
    if (level.next == 0) break;
    const std::uint32_t index = level.next - 1;
    if (level.type->kind == Kind::kSequence || level.type->kind == Kind::kArray) {
      text += "[" + std::to_string(index) + "]";
    } else {
      const bool is_chosen = level.type->kind == Kind::kUnion && index > 0;
      text += (text.empty() ? "" : ".") + (is_chosen ? level.chosen->name : level.type->members[index].name);
    }
  }
  return text;
}

}  // namespace baton::schema
