#include "schema/idl_names.hpp"

#include <charconv>
#include <limits>
#include <utility>

#include "schema/limits.hpp"

namespace baton::schema {
namespace {

/// The numbers of an integer kind, as far as int64 reaches.
std::pair<std::int64_t, std::int64_t> rangeOf(Kind kind) {
  const auto range = [](auto number) -> std::pair<std::int64_t, std::int64_t> {
    return {std::numeric_limits<decltype(number)>::min(), std::numeric_limits<decltype(number)>::max()};
  };
  switch (kind) {
    case Kind::kInt8: return range(std::int8_t{});
    case Kind::kUint8: return range(std::uint8_t{});
    case Kind::kInt16: return range(std::int16_t{});
    case Kind::kUint16: return range(std::uint16_t{});
    case Kind::kInt32: return range(std::int32_t{});
    case Kind::kUint32: return range(std::uint32_t{});
    case Kind::kUint64: return {0, std::numeric_limits<std::int64_t>::max()};
    default: return range(std::int64_t{});
  }
}

}  // namespace

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
  if (full.size() > kMaxNameBytes) {
    lexer_.fail("names of at most " + std::to_string(kMaxNameBytes) + " bytes", "a longer one");
  }
  if (types_.contains(full) || constants_.contains(full) || unusable_.contains(full))
    lexer_.fail("a new name", "'" + full + "' again");
  return full;
}

void IdlNames::addUnusable(const std::string& full_name, std::size_t problem) {
  types_.erase(full_name);
  unusable_.try_emplace(full_name, problem);
}

void IdlNames::addConstant(const std::string& full_name, Constant constant) {
  if (size() >= kMaxDefinitions) lexer_.fail("at most " + std::to_string(kMaxDefinitions) + " names", "more");
  constants_.emplace(full_name, constant);
}

const Type* IdlNames::type() {
  const std::size_t line = lexer_.token().line;
  const std::string name = lexer_.scopedName("a type");
  const auto* type = lookUp(types_, name);
  if (type == nullptr) failAt(line, "a type that was declared before", "'" + name + "'");
  return *type;
}

std::int64_t IdlNames::integer(std::int64_t smallest, std::int64_t largest) {
  const Token token = lexer_.token();
  const std::string wanted = "a whole number from " + std::to_string(smallest) + " to " + std::to_string(largest);
  const auto isWithin = [&](std::int64_t value) { return value >= smallest && value <= largest; };
  if (token.kind == Token::Kind::kWord || lexer_.is("::")) {
    const std::string name = lexer_.scopedName(wanted);
    const Constant* constant = lookUp(constants_, name);
    if (constant == nullptr || !isInteger(constant->type->kind) || !isWithin(constant->value.value())) {
      failAt(token.line, wanted, "'" + name + "'");
    }
    return *constant->value;
  }
  const bool is_negative = lexer_.accept("-");
  if (!is_negative) lexer_.accept("+");
  const std::string_view written = lexer_.token().text;
  const std::string digits = (is_negative ? "-" : "") + std::string(written);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_whole = error == std::errc() && end == digits.data() + digits.size();
  const bool is_octal = written.size() > 1 && written.front() == '0';
  if (lexer_.token().kind != Token::Kind::kNumber || !is_whole || is_octal || !isWithin(value)) lexer_.fail(wanted);
  lexer_.advance();
  return value;
}

std::optional<std::int64_t> IdlNames::value(const Type& type) {
  if (isInteger(type.kind)) {
    const auto [smallest, largest] = rangeOf(type.kind);
    return integer(smallest, largest);
  }
  const bool is_boolean = type.kind == Kind::kBoolean;
  if (is_boolean && lexer_.accept("TRUE")) return 1;
  if (is_boolean && lexer_.accept("FALSE")) return 0;
  if (type.kind == Kind::kString && lexer_.token().kind == Token::Kind::kString) {
    while (lexer_.token().kind == Token::Kind::kString) lexer_.advance();
    return std::nullopt;
  }
  const bool has_sign = lexer_.is("-") || lexer_.is("+");
  if ((type.kind == Kind::kFloat || type.kind == Kind::kDouble) &&
      (has_sign || lexer_.token().kind == Token::Kind::kNumber)) {
    if (has_sign) lexer_.advance();
    if (lexer_.token().kind != Token::Kind::kNumber) lexer_.fail("a number");
    lexer_.advance();
    return std::nullopt;
  }
  const std::size_t line = lexer_.token().line;
  const std::string name = lexer_.scopedName("a value of the type");
  const Constant* constant = lookUp(constants_, name);
  const bool is_same =
      constant != nullptr && constant->type->kind == type.kind && (type.kind != Kind::kEnum || constant->type == &type);
  if (!is_same) failAt(line, "a value of the type", "'" + name + "'");
  return constant->value;
}

}  // namespace baton::schema
