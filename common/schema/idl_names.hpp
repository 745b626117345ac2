/// What names mean in an IDL text, and the constants among them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "schema/error.hpp"
#include "schema/idl_lexer.hpp"
#include "schema/type.hpp"

namespace baton::schema {

/// Holds every number of 64 bits, signed or unsigned.
__extension__ using Number = __int128;

struct Constant {
  const Type* type = nullptr;
  std::optional<Number> value{};  // nothing for a string or a number with a fraction
};

using TypeNames = std::map<std::string, const Type*, std::less<>>;
using UnusableNames = std::map<std::string, std::size_t, std::less<>>;  // index of the problem with their definition

/// A name was used whose definition cannot be.
class UnusableName : public IdlError {
 public:
  explicit UnusableName(std::size_t problem) : IdlError("a definition that cannot be used"), problem_(problem) {}
  [[nodiscard]] std::size_t problem() const { return problem_; }

 private:
  std::size_t problem_;
};

class IdlNames {
 public:
  IdlNames(IdlLexer& lexer, TypeNames& types, UnusableNames& unusable)
      : lexer_(lexer), types_(types), unusable_(unusable) {}

  /// Everything declared until leave() belongs to the module. Returns what leave() takes.
  [[nodiscard]] std::string enter(const std::string& module);
  void leave(const std::string& outer) { scope_ = outer; }
  [[nodiscard]] const std::string& scope() const { return scope_; }

  /// A name that is to be declared here, with its modules. Throws IdlError when it has a meaning already.
  [[nodiscard]] std::string claim(const std::string& name) const;
  [[nodiscard]] bool isNew(const std::string& name) const;
  void addType(const std::string& full_name, const Type* type) { types_.emplace(full_name, type); }
  /// Whatever uses it from here on throws UnusableName.
  void addUnusable(const std::string& full_name, std::size_t problem);
  /// @param name  taken from claim(), or further down.
  void addConstant(const std::string& full_name, Constant constant);
  [[nodiscard]] std::size_t size() const { return types_.size() + constants_.size() + unusable_.size(); }

  /// Takes the name of a type that was declared before.
  [[nodiscard]] const Type* type();
  [[nodiscard]] bool hasType(const std::string& name) const;
  /// Null when no constant has the name.
  [[nodiscard]] const Constant* constant(const std::string& name) const;

 private:
  template <class Map>
  [[nodiscard]] const typename Map::mapped_type* lookUp(const Map& map, const std::string& name) const;

  IdlLexer& lexer_;
  TypeNames& types_;
  UnusableNames& unusable_;
  std::map<std::string, Constant, std::less<>> constants_;
  std::string scope_;  // "baton::msg::"
};

[[nodiscard]] constexpr bool isInteger(Kind kind) { return kind >= Kind::kInt8 && kind <= Kind::kUint64; }

}  // namespace baton::schema
