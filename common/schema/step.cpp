#include "schema/step.hpp"

#include <algorithm>

#include "schema/error.hpp"

namespace baton::schema {
namespace {

const Member* stepMember(const Type& type) {
  if (type.kind != Kind::kStruct) return nullptr;
  const auto member = std::ranges::find(type.members, "step", &Member::name);
  return member == type.members.end() || member->type->kind != Kind::kUint64 ? nullptr : &*member;
}

}  // namespace

bool hasStep(const Type& type) { return stepMember(type) != nullptr; }

std::optional<std::uint64_t> stepOf(const Type& type, Bytes message) {
  const Member* member = stepMember(type);
  if (member == nullptr) return std::nullopt;
  try {
    MessageReader reader(type, message);
    for (Item item; reader.next(item);) {
      if (item.member == member) return std::get<std::uint64_t>(item.value);
    }
  } catch (const PayloadError&) {  // it has none that could be read
  }
  return std::nullopt;
}

}  // namespace baton::schema
