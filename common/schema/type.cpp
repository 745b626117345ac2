#include "schema/type.hpp"

#include <algorithm>

namespace baton::schema {

std::string_view enumeratorName(const Type& type, std::int64_t value) {
  const auto found = type.enumerators.find(value);
  return found == type.enumerators.end() ? std::string_view() : found->second;
}

const Member* chosenMember(const Type& type, std::int64_t discriminator) {
  const auto label = std::ranges::find_if(type.labels, [&](const Label& one) { return one.value == discriminator; });
  const std::size_t index = label == type.labels.end() ? type.default_member : label->member;
  return index == 0 ? nullptr : &type.members[index];
}

const Type* TypeSet::find(std::string_view name) const {
  const auto found = names_.find(name);
  return found == names_.end() ? nullptr : found->second;
}

const Problem* TypeSet::problemOf(std::string_view name) const {
  for (;;) {
    if (const auto found = unusable_.find(name); found != unusable_.end()) return &problems_[found->second];
    const std::size_t outer = name.rfind("::");
    if (outer == std::string_view::npos) return nullptr;
    name = name.substr(0, outer);
  }
}

}  // namespace baton::schema
