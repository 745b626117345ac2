#include "schema/idl_annotations.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <string_view>

namespace baton::schema {
namespace {

// Annotations that put a member elsewhere than its place among the others, or nowhere.
constexpr std::array<std::string_view, 3> kMoving{"optional", "non_serialized", "nonserialized"};

/// Older IDL of some vendors writes @Key and @Extensibility(FINAL_EXTENSIBILITY).
std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

}  // namespace

Annotations IdlAnnotations::read() {
  Annotations all;
  while (lexer_.accept("@")) {
    const std::string name = this->name();
    if (name == "unit") {
      all.unit = unit();
    } else if (name == "value") {
      all.value = number(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max());
    } else if (name == "bit_bound") {
      all.bit_bound = number(1, 64);
    } else if (name == "position") {
      all.position = number(0, 63);
    } else if (name == "extensibility") {
      expectPlain(extensibility());
    } else if (std::ranges::count(kMoving, name) > 0) {
      lexer_.fail("a member that always has its place in a payload", "@" + name + ", which is not supported");
    } else {
      all.is_key = all.is_key || name == "key";
      all.is_declaration = all.is_declaration || name == "annotation";
      expectPlain(name);
      if (lexer_.accept("(")) lexer_.skipTo(")", "(");
    }
  }
  return all;
}

/// Without the vendor's or module's name before it.
std::string IdlAnnotations::name() {
  std::string name;
  do {
    if (lexer_.token().kind != Token::Kind::kWord) lexer_.fail("an annotation's name");
    name = lowerCase(lexer_.token().text);
    lexer_.advance();
  } while (lexer_.accept("::"));
  return name;
}

/// Final and appendable types are the same in plain CDR.
void IdlAnnotations::expectPlain(const std::string& extensibility) const {
  if (extensibility.starts_with("mutable")) {
    lexer_.fail("a final or an appendable type", "a mutable one, whose parameter lists are not supported");
  }
}

std::string IdlAnnotations::extensibility() {
  openArgument();
  const std::string kind = lexer_.token().kind == Token::Kind::kWord ? lowerCase(lexer_.token().text) : "";
  for (const char* known : {"final", "appendable", "extensible", "mutable"}) {
    if (!kind.starts_with(known)) continue;
    lexer_.advance();
    lexer_.expect(")");
    return kind;
  }
  lexer_.fail("FINAL, APPENDABLE or MUTABLE");
}

std::string IdlAnnotations::unit() {
  openArgument();
  if (lexer_.token().kind != Token::Kind::kString) lexer_.fail("the unit as a string");
  std::string text(lexer_.token().text);
  lexer_.advance();
  lexer_.expect(")");
  return text;
}

std::int64_t IdlAnnotations::number(std::int64_t smallest, std::int64_t largest) {
  openArgument();
  const std::int64_t number = values_.integer(smallest, largest);
  lexer_.expect(")");
  return number;
}

/// An annotation's only argument may be called by its name.
void IdlAnnotations::openArgument() {
  lexer_.expect("(");
  if (lexer_.accept("value")) lexer_.expect("=");
}

}  // namespace baton::schema
