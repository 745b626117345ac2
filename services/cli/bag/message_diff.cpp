#include "bag/message_diff.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "bag/message_text.hpp"
#include "schema/error.hpp"

namespace baton {
namespace {

using schema::Item;

/// Bit by bit: -0 is not 0, and every not-a-number is another.
bool isSame(const schema::Value& a, const schema::Value& b) {
  if (a.index() != b.index()) return false;
  if (const auto* x = std::get_if<double>(&a)) {
    return std::bit_cast<std::uint64_t>(*x) == std::bit_cast<std::uint64_t>(std::get<double>(b));
  }
  if (const auto* x = std::get_if<float>(&a)) {
    return std::bit_cast<std::uint32_t>(*x) == std::bit_cast<std::uint32_t>(std::get<float>(b));
  }
  if (const auto* x = std::get_if<schema::Bytes>(&a)) return std::ranges::equal(*x, std::get<schema::Bytes>(b));
  if (const auto* x = std::get_if<std::string_view>(&a)) return *x == std::get<std::string_view>(b);
  if (const auto* x = std::get_if<bool>(&a)) return *x == std::get<bool>(b);
  if (const auto* x = std::get_if<std::int64_t>(&a)) return *x == std::get<std::int64_t>(b);
  return std::get<std::uint64_t>(a) == std::get<std::uint64_t>(b);
}

/// How far two numbers are apart; nothing for what is not two numbers of a kind.
std::optional<double> distance(const schema::Value& a, const schema::Value& b) {
  if (a.index() != b.index()) return std::nullopt;
  const auto ofReals = [](double x, double y) {
    const bool is_same = x == y || (std::isnan(x) && std::isnan(y));
    return is_same ? 0.0 : std::isnan(x - y) ? HUGE_VAL : std::abs(x - y);
  };
  // Without overflow: the difference of two's complements.
  const auto ofIntegers = [](std::uint64_t larger, std::uint64_t smaller) {
    return static_cast<double>(larger - smaller);
  };
  if (const auto* x = std::get_if<double>(&a)) return ofReals(*x, std::get<double>(b));
  if (const auto* x = std::get_if<float>(&a)) return ofReals(*x, std::get<float>(b));
  if (const auto* x = std::get_if<std::int64_t>(&a)) {
    const auto [smaller, larger] = std::minmax(*x, std::get<std::int64_t>(b));
    return ofIntegers(static_cast<std::uint64_t>(larger), static_cast<std::uint64_t>(smaller));
  }
  if (const auto* x = std::get_if<std::uint64_t>(&a)) {
    const auto [smaller, larger] = std::minmax(*x, std::get<std::uint64_t>(b));
    return ofIntegers(larger, smaller);
  }
  return std::nullopt;
}

std::string describe(const Item& item) {
  switch (item.what) {
    case Item::What::kValue: return plainText(*item.type, item.value);
    case Item::What::kBegin:
      return item.member != nullptr && item.count == 0 ? "a " + item.member->name
                                                       : std::to_string(item.count) + " elements";
    case Item::What::kEnd: break;
  }
  return "nothing";
}

/// Goes on behind a struct, union, sequence or array that has just begun.
void skip(schema::MessageReader& reader) {
  std::size_t depth = 1;
  for (Item item; depth > 0 && reader.next(item);) {
    if (item.what == Item::What::kBegin) ++depth;
    if (item.what == Item::What::kEnd) --depth;
  }
}

/// Both stand at the same place of the same kind of thing.
bool isAlike(const Item& a, const Item& b) {
  if (a.what != b.what || a.count != b.count) return false;
  if (a.member == nullptr || b.member == nullptr) return a.member == b.member;
  return a.member->name == b.member->name;
}

bool isWithin(const std::optional<double>& allowed, const schema::Value& a, const schema::Value& b) {
  if (!allowed) return false;
  const std::optional<double> apart = distance(a, b);
  return apart && *apart <= *allowed;
}

std::optional<FieldDifference> compareValues(const TypedPayload& a, const TypedPayload& b, const FieldRules& rules) {
  schema::MessageReader first(*a.type, a.bytes), second(*b.type, b.bytes);
  for (Item x, y;;) {
    const bool has_x = first.next(x), has_y = second.next(y);
    if (!has_x && !has_y) return std::nullopt;
    if (!has_x) x = {};
    if (!has_y) y = {};
    const bool is_alike = has_x == has_y && isAlike(x, y);
    if (is_alike && x.what == Item::What::kEnd) continue;
    if (is_alike && x.what == Item::What::kValue && isSame(x.value, y.value)) continue;
    const std::string path = first.path();
    if (x.what != Item::What::kEnd && y.what != Item::What::kEnd && rules.ignores(path)) {
      if (x.what == Item::What::kBegin) skip(first);
      if (y.what == Item::What::kBegin) skip(second);
      continue;
    }
    const bool is_begin = x.what == Item::What::kBegin;
    if (is_alike && (is_begin || isWithin(rules.tolerance(path), x.value, y.value))) continue;
    return FieldDifference{path, describe(x), describe(y)};
  }
}

}  // namespace

std::optional<FieldDifference> compare(const TypedPayload& a, const TypedPayload& b, const FieldRules& rules) {
  if (std::ranges::equal(a.bytes, b.bytes)) return std::nullopt;
  const auto sizeOf = [](const TypedPayload& one) { return std::to_string(one.bytes.size()) + " bytes"; };
  if (a.type == nullptr || b.type == nullptr) {
    const auto [x, y] = std::ranges::mismatch(a.bytes, b.bytes);
    const auto textAt = [](schema::Bytes bytes, auto at) {
      const auto begin = static_cast<std::size_t>(at - bytes.begin());
      return begin == bytes.size() ? "nothing"
                                   : hexOf(bytes.subspan(begin, std::min<std::size_t>(8, bytes.size() - begin)));
    };
    return FieldDifference{"byte " + std::to_string(x - a.bytes.begin()), textAt(a.bytes, x), textAt(b.bytes, y)};
  }
  try {
    if (auto difference = compareValues(a, b, rules)) return difference;
  } catch (const schema::PayloadError& error) {
    return FieldDifference{"", sizeOf(a), sizeOf(b) + ", one of them none of the type: " + error.what()};
  }
  if (!rules.empty()) return std::nullopt;
  return FieldDifference{"", sizeOf(a), sizeOf(b) + ": the same values, encoded otherwise"};
}

}  // namespace baton
