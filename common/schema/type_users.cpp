#include "schema/type_users.hpp"

namespace baton::schema {

TypeUsers::TypeUsers(const std::deque<Type>& types, const TypeNames& names) {
  for (const Type& type : types) {
    if (type.element != nullptr) users_.emplace(type.element, &type);
    for (const Member& one : type.members) users_.emplace(one.type, &type);
  }
  for (const auto& [name, type] : names) names_.emplace(type, name);
}

std::vector<std::string> TypeUsers::take(const Type& type) {
  std::vector<std::string> found;
  std::vector<const Type*> to_see{&type};
  while (!to_see.empty()) {
    const Type* next = to_see.back();
    to_see.pop_back();
    if (!seen_.insert(next).second) continue;
    for (auto [one, end] = names_.equal_range(next); one != end; ++one) found.push_back(one->second);
    for (auto [one, end] = users_.equal_range(next); one != end; ++one) to_see.push_back(one->second);
  }
  return found;
}

}  // namespace baton::schema
