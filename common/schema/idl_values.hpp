/// Constant expressions of an IDL text: sizes, bounds, labels and the values of constants.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/idl_lexer.hpp"
#include "schema/idl_names.hpp"
#include "schema/type.hpp"

namespace baton::schema {

/// Evaluates while it reads. What is computed on the way has to fit into 64 bits as well, signed or unsigned.
class IdlValues {
 public:
  IdlValues(IdlLexer& lexer, const IdlNames& names) : lexer_(lexer), names_(names) {}

  /// Takes a whole number.
  [[nodiscard]] std::int64_t integer(std::int64_t smallest, std::int64_t largest);
  /// Takes a bound before a '>', which is no sign of the number: sequence<sequence<long, 4>>.
  [[nodiscard]] std::int64_t integerBeforeAngle(std::int64_t smallest, std::int64_t largest);
  /// Takes a value of the type; nothing for a string and for a number that may have a fraction.
  [[nodiscard]] std::optional<Number> value(const Type& type);

 private:
  struct Wanted {
    std::string text;  // "a whole number from 1 to 8"
    Number smallest = 0, largest = 0;
    Number bits = 0;             // all bits of an unsigned type
    bool is_fractional = false;  // no value is computed
    bool ends_at_angle = false;
  };
  using Operand = std::optional<Number>;  // nothing while is_fractional

  [[nodiscard]] Number whole(Wanted wanted);
  [[nodiscard]] Operand expression(std::size_t rank);
  [[nodiscard]] Operand unary();
  [[nodiscard]] Operand primary();
  [[nodiscard]] Operand named();
  [[nodiscard]] bool acceptOperator(std::string_view sign);
  [[nodiscard]] Number applied(std::string_view sign, Number left, Number right, std::size_t line) const;
  [[nodiscard]] Number complement(Number value, std::size_t line) const;
  [[nodiscard]] Number character(Number largest);
  [[nodiscard]] std::optional<Number> constantOf(const Type& type);

  IdlLexer& lexer_;
  const IdlNames& names_;
  Wanted wanted_;
  unsigned depth_ = 0;  // of parentheses
};

}  // namespace baton::schema
