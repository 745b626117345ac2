#include "schema/idl_values.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <span>
#include <utility>

#include "schema/limits.hpp"

namespace baton::schema {
namespace {

// Weakest first; what stands in one row is taken from left to right (IDL 4.2, 7.4.1.4.3).
constexpr std::array<std::array<std::string_view, 3>, 6> kOperators{
    {{"|"}, {"^"}, {"&"}, {"<<", ">>"}, {"+", "-"}, {"*", "/", "%"}}};

constexpr Number kLeast = std::numeric_limits<std::int64_t>::min();
constexpr Number kMost = std::numeric_limits<std::uint64_t>::max();

/// Of a number between those.
std::string textOf(Number value) {
  return value < 0 ? std::to_string(static_cast<std::int64_t>(value))
                   : std::to_string(static_cast<std::uint64_t>(value));
}

template <class T>
constexpr std::pair<Number, Number> limitsOf() {
  return {std::numeric_limits<T>::min(), std::numeric_limits<T>::max()};
}
std::pair<Number, Number> rangeOf(Kind kind) {
  switch (kind) {
    case Kind::kInt8: return limitsOf<std::int8_t>();
    case Kind::kOctet:
    case Kind::kUint8: return limitsOf<std::uint8_t>();
    case Kind::kInt16: return limitsOf<std::int16_t>();
    case Kind::kUint16: return limitsOf<std::uint16_t>();
    case Kind::kInt32: return limitsOf<std::int32_t>();
    case Kind::kUint32: return limitsOf<std::uint32_t>();
    case Kind::kUint64: return limitsOf<std::uint64_t>();
    default: return limitsOf<std::int64_t>();
  }
}

std::string wholeNumber(Number smallest, Number largest) {
  return "a whole number from " + textOf(smallest) + " to " + textOf(largest);
}

/// "12", "0x1F", "017"; nothing for what is no whole number of 64 bits.
std::optional<Number> literal(std::string_view text) {
  const bool is_hex = text.starts_with("0x") || text.starts_with("0X");
  const bool is_octal = !is_hex && text.size() > 1 && text.front() == '0';
  if (is_hex) text.remove_prefix(2);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value,
                                            is_hex     ? 16
                                            : is_octal ? 8
                                                       : 10);
  return error == std::errc() && end == text.data() + text.size() ? std::optional<Number>(value) : std::nullopt;
}

/// The code that is written behind a backslash as a number, in up to so many digits.
std::optional<Number> escapedCode(std::string_view digits, std::size_t most, int base) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
  const bool is_code = error == std::errc() && end == digits.data() + digits.size() && digits.size() <= most;
  return is_code ? std::optional<Number>(value) : std::nullopt;
}

/// The code of what stands between the quotes of a character; nothing for what is none.
std::optional<Number> characterCode(std::string_view text) {
  if (text.size() == 1 && text != "\\") return static_cast<unsigned char>(text.front());
  if (text.size() < 2 || text.front() != '\\') return std::nullopt;
  static constexpr std::string_view kNames = "ntvbrfa\\?'\"", kMeanings = "\n\t\v\b\r\f\a\\?'\"";
  const std::size_t name = kNames.find(text[1]);
  if (text.size() == 2 && name != std::string_view::npos) return static_cast<unsigned char>(kMeanings[name]);
  if (text[1] == 'x') return escapedCode(text.substr(2), 4, 16);
  if (text[1] == 'u') return escapedCode(text.substr(2), 4, 16);
  return escapedCode(text.substr(1), 3, 8);
}

}  // namespace

std::int64_t IdlValues::integer(std::int64_t smallest, std::int64_t largest) {
  return static_cast<std::int64_t>(
      whole({.text = wholeNumber(smallest, largest), .smallest = smallest, .largest = largest}));
}

std::int64_t IdlValues::integerBeforeAngle(std::int64_t smallest, std::int64_t largest) {
  return static_cast<std::int64_t>(
      whole({.text = wholeNumber(smallest, largest), .smallest = smallest, .largest = largest, .ends_at_angle = true}));
}

Number IdlValues::whole(Wanted wanted) {
  wanted_ = std::move(wanted);
  depth_ = 0;
  const std::size_t line = lexer_.token().line;
  const Number value = expression(0).value();
  if (value < wanted_.smallest || value > wanted_.largest) failAt(line, wanted_.text, textOf(value));
  return value;
}

std::optional<Number> IdlValues::value(const Type& type) {
  if (isInteger(type.kind) || type.kind == Kind::kOctet) {
    const auto [smallest, largest] = rangeOf(type.kind);
    return whole({.text = wholeNumber(smallest, largest),
                  .smallest = smallest,
                  .largest = largest,
                  .bits = smallest == 0 ? largest : 0});
  }
  if (type.kind == Kind::kFloat || type.kind == Kind::kDouble) {
    wanted_ = {.text = "a number", .is_fractional = true};
    depth_ = 0;
    return expression(0);
  }
  const bool is_literal = lexer_.token().kind == Token::Kind::kString;
  if (type.kind == Kind::kString && is_literal) {
    while (lexer_.token().kind == Token::Kind::kString) lexer_.advance();
    return std::nullopt;
  }
  if (type.kind == Kind::kBoolean && lexer_.accept("TRUE")) return 1;
  if (type.kind == Kind::kBoolean && lexer_.accept("FALSE")) return 0;
  if (type.kind == Kind::kChar && lexer_.token().kind == Token::Kind::kCharacter) return character(0xFF);
  if (type.kind == Kind::kWideChar && (lexer_.accept("L") || lexer_.token().kind == Token::Kind::kCharacter)) {
    return character(0xFFFF);
  }
  return constantOf(type);
}

/// Takes a character whose code is no larger.
Number IdlValues::character(Number largest) {
  const Token token = lexer_.token();
  const std::optional<Number> code = characterCode(token.text);
  const bool is_character = token.kind == Token::Kind::kCharacter && code && *code <= largest;
  if (!is_character) lexer_.fail("a character of the type");
  lexer_.advance();
  return *code;
}

std::optional<Number> IdlValues::constantOf(const Type& type) {
  const std::size_t line = lexer_.token().line;
  const std::string name = lexer_.scopedName("a value of the type");
  const Constant* constant = names_.constant(name);
  const bool is_same =
      constant != nullptr && constant->type->kind == type.kind && (type.kind != Kind::kEnum || constant->type == &type);
  if (!is_same) failAt(line, "a value of the type", "'" + name + "'");
  return constant->value;
}

// --- expressions

/// Recursion: as deep as there are ranks, within each of the parentheses.
IdlValues::Operand IdlValues::expression(std::size_t rank) {
  if (rank == kOperators.size()) return unary();
  Operand left = expression(rank + 1);
  for (;;) {
    const std::size_t line = lexer_.token().line;
    const auto& signs = kOperators[rank];
    const auto sign = std::ranges::find_if(signs, [&](std::string_view one) { return acceptOperator(one); });
    if (sign == signs.end()) return left;
    const Operand right = expression(rank + 1);
    left = left && right ? Operand(applied(*sign, *left, *right, line)) : std::nullopt;
  }
}

bool IdlValues::acceptOperator(std::string_view sign) {
  if (sign.empty() || (sign == ">>" && wanted_.ends_at_angle && depth_ == 0)) return false;
  return sign.size() == 1 ? lexer_.accept(sign) : lexer_.acceptTwice(sign.substr(0, 1));
}

IdlValues::Operand IdlValues::unary() {
  const bool is_negative = lexer_.accept("-");
  const bool is_complement = !is_negative && lexer_.accept("~");
  if (!is_negative && !is_complement) lexer_.accept("+");
  const std::size_t line = lexer_.token().line;
  const Operand operand = primary();
  if (!operand || (!is_negative && !is_complement)) return operand;
  return is_negative ? applied("-", 0, *operand, line) : complement(*operand, line);
}

/// All bits of the type; one without a sign stays without.
Number IdlValues::complement(Number value, std::size_t line) const {
  const bool is_unsigned = wanted_.bits > 0 && value >= 0 && value <= wanted_.bits;
  return applied("-", is_unsigned ? wanted_.bits : -1, value, line);
}

IdlValues::Operand IdlValues::primary() {
  const Token token = lexer_.token();
  if (lexer_.accept("(")) {
    if (++depth_ > kMaxDepth) lexer_.failBeyond(kMaxDepth, "parentheses within each other");
    const Operand inner = expression(0);
    lexer_.expect(")");
    --depth_;
    return inner;
  }
  if (token.kind == Token::Kind::kWord || lexer_.is("::")) return named();
  if (token.kind != Token::Kind::kNumber) lexer_.fail(wanted_.text);
  const std::optional<Number> value = literal(token.text);
  if (!value && !wanted_.is_fractional) lexer_.fail(wanted_.text);
  lexer_.advance();
  return wanted_.is_fractional ? std::nullopt : value;
}

/// A constant that is a number.
IdlValues::Operand IdlValues::named() {
  const std::size_t line = lexer_.token().line;
  const std::string name = lexer_.scopedName(wanted_.text);
  const Constant* constant = names_.constant(name);
  const Kind kind = constant == nullptr ? Kind::kStruct : constant->type->kind;
  const bool is_whole = isInteger(kind) || kind == Kind::kOctet;
  const bool is_number = is_whole || (wanted_.is_fractional && (kind == Kind::kFloat || kind == Kind::kDouble));
  if (!is_number) failAt(line, wanted_.text, "'" + name + "'");
  return wanted_.is_fractional ? std::nullopt : constant->value;
}

Number IdlValues::applied(std::string_view sign, Number left, Number right, std::size_t line) const {
  const char first = sign.front();
  const bool is_shift = first == '<' || first == '>';
  if ((first == '/' || first == '%') && right == 0) failAt(line, "a divisor that is not 0", "0");
  if (is_shift && left < 0) failAt(line, "a number to shift that is not negative", textOf(left));
  if (is_shift && (right < 0 || right > 63)) failAt(line, "a shift by 0 to 63 bits", textOf(right));
  Number result = 0;
  bool is_beyond = false;
  switch (first) {
    case '|': result = left | right; break;
    case '^': result = left ^ right; break;
    case '&': result = left & right; break;
    case '<': result = left << right; break;  // at most 127 bits
    case '>': result = left >> right; break;
    case '+': result = left + right; break;
    case '-': result = left - right; break;
    case '*': is_beyond = __builtin_mul_overflow(left, right, &result); break;
    case '/': result = left / right; break;
    default: result = left % right; break;
  }
  if (is_beyond || result < kLeast || result > kMost) {
    failAt(line, wanted_.text, "a result beyond 64 bits");
  }
  return result;
}

}  // namespace baton::schema
