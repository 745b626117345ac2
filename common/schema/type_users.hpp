/// Which names of a text a type stands behind.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "schema/idl_names.hpp"
#include "schema/type.hpp"

namespace baton::schema {

class TypeUsers {
 public:
  /// Both outlive it, and the types stay as they are.
  TypeUsers(const std::deque<Type>& types, const TypeNames& names);

  /// Names of the type and of all that it is used by, directly or not; without those that were told before.
  [[nodiscard]] std::vector<std::string> take(const Type& type);

 private:
  std::multimap<const Type*, const Type*> users_;
  std::multimap<const Type*, std::string> names_;
  std::set<const Type*> seen_;
};

}  // namespace baton::schema
