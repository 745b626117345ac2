/// Annotations of an IDL text: those that are kept, and those that no payload could be read with.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/idl_lexer.hpp"
#include "schema/idl_values.hpp"

namespace baton::schema {

struct Annotations {
  std::string unit;
  bool is_key = false;
  std::optional<std::int64_t> value;      // of an enumerator
  std::optional<std::int64_t> bit_bound;  // of an enum or a bitmask
  std::optional<std::int64_t> position;   // of a bit in a bitmask
  bool is_declaration = false;            // what follows says what an annotation is
};

class IdlAnnotations {
 public:
  IdlAnnotations(IdlLexer& lexer, IdlValues& values) : lexer_(lexer), values_(values) {}

  /// Takes all that come next. Throws IdlError for one that changes how a payload is read.
  [[nodiscard]] Annotations read();

 private:
  [[nodiscard]] std::string name();
  [[nodiscard]] std::string extensibility();
  [[nodiscard]] std::string unit();
  [[nodiscard]] std::int64_t number(std::int64_t smallest, std::int64_t largest);
  void expectPlain(const std::string& extensibility) const;
  void openArgument();

  IdlLexer& lexer_;
  IdlValues& values_;
};

}  // namespace baton::schema
