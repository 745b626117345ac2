#include "schema/instance.hpp"

#include <algorithm>
#include <type_traits>

#include "schema/error.hpp"

namespace baton::schema {
namespace {

/// Texts and bytes with their length, so that no two lists of values give the same.
void append(std::string& to, const Value& value) {
  std::visit(
      [&](const auto& one) {
        using One = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<One, std::string_view> || std::is_same_v<One, Bytes>) {
          const std::size_t size = one.size();
          to.append(reinterpret_cast<const char*>(&size), sizeof size);
          to.append(reinterpret_cast<const char*>(one.data()), one.size());
        } else {
          to.append(reinterpret_cast<const char*>(&one), sizeof one);
        }
      },
      value);
}

}  // namespace

std::string instanceOf(const Type& type, Bytes message) {
  if (type.kind != Kind::kStruct || std::ranges::none_of(type.members, &Member::is_key)) return "";
  std::string instance;
  try {
    MessageReader reader(type, message);
    std::size_t depth = 0;  // of what is open; 1 within the message itself
    bool is_key = false;    // the member of the message that is being read
    for (Item item; reader.next(item);) {
      if (item.what == Item::What::kEnd) --depth;
      if (depth == 1 && item.member != nullptr && item.what != Item::What::kEnd) is_key = item.member->is_key;
      if (item.what == Item::What::kBegin) ++depth;
      if (item.what == Item::What::kValue && is_key) append(instance, item.value);
    }
  } catch (const PayloadError&) {
    return "";
  }
  return instance;
}

}  // namespace baton::schema
