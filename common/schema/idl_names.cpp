#include "schema/idl_names.hpp"

#include <utility>

#include "schema/limits.hpp"

namespace baton::schema {
/// The meaning of a name in this module or, going outwards, in one around it; null when it has none.
template <class Map>
const typename Map::mapped_type* IdlNames::lookUp(const Map& map, const std::string& name) const {
  const bool is_global = name.starts_with("::");
  std::string scope = is_global ? "" : scope_;
  while (true) {
    const std::string full = scope + (is_global ? name.substr(2) : name);
    if (const auto found = unusable_.find(full); found != unusable_.end()) throw UnusableName(found->second);
    if (const auto found = map.find(full); found != map.end()) return &found->second;
    if (scope.empty()) return nullptr;
    scope.resize(scope.size() - 2);  // the last "::"
    const std::size_t outer = scope.rfind("::");
    scope.resize(outer == std::string::npos ? 0 : outer + 2);
  }
}

std::string IdlNames::enter(const std::string& module) {
  std::string inner = claim(module) + "::";
  return std::exchange(scope_, std::move(inner));
}

std::string IdlNames::claim(const std::string& name) const {
  std::string full = scope_ + name;
  if (full.size() > kMaxNameBytes) lexer_.failBeyond(kMaxNameBytes, "bytes in a name");
  if (!isNew(name)) lexer_.fail("a new name", "'" + full + "' again");
  return full;
}

bool IdlNames::isNew(const std::string& name) const {
  const std::string full = scope_ + name;
  return !types_.contains(full) && !constants_.contains(full) && !unusable_.contains(full);
}

void IdlNames::addUnusable(const std::string& full_name, std::size_t problem) {
  types_.erase(full_name);
  unusable_.try_emplace(full_name, problem);
}

void IdlNames::addConstant(const std::string& full_name, Constant constant) {
  if (size() >= kMaxDefinitions) lexer_.failBeyond(kMaxDefinitions, "names");
  constants_.emplace(full_name, constant);
}

bool IdlNames::hasType(const std::string& name) const { return lookUp(types_, name) != nullptr; }

const Constant* IdlNames::constant(const std::string& name) const { return lookUp(constants_, name); }

const Type* IdlNames::type() {
  const std::size_t line = lexer_.token().line;
  const std::string name = lexer_.scopedName("a type");
  const auto* type = lookUp(types_, name);
  if (type == nullptr) failAt(line, "a type that was declared before", "'" + name + "'");
  return *type;
}

}  // namespace baton::schema
