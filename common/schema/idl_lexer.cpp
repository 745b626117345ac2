#include "schema/idl_lexer.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "schema/error.hpp"
#include "schema/limits.hpp"

namespace baton::schema {
namespace {

// Words that nothing is called by. Those that IDL has only had since 4.0 or outside of types are names where a name
// stands: OccupancyGrid map.
constexpr std::array<std::string_view, 23> kKeywords{"module",   "struct",  "union",   "switch",   "case",   "default",
                                                     "enum",     "typedef", "const",   "sequence", "string", "wstring",
                                                     "char",     "wchar",   "boolean", "octet",    "short",  "long",
                                                     "unsigned", "float",   "double",  "TRUE",     "FALSE"};

bool isLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

template <class Is>
std::size_t lengthOf(std::string_view text, Is is) {
  return static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is) - text.begin());
}

/// #pragma and marks of where the text came from.
bool isHarmless(std::string_view directive) {
  directive.remove_prefix(1);
  directive.remove_prefix(lengthOf(directive, [](char c) { return c == ' ' || c == '\t'; }));
  return directive.starts_with("pragma") || directive.starts_with("line") ||
         (!directive.empty() && isDigit(directive.front()));
}

}  // namespace

void failAt(std::size_t line, const std::string& expected, const std::string& found) {
  throw IdlError("line " + std::to_string(line) + ": expected " + expected + ", found " + found);
}

Token IdlLexer::take(Token::Kind kind, std::size_t length) {
  const Token token{kind, rest_.substr(0, length), line_};
  line_ += static_cast<std::size_t>(std::ranges::count(token.text, '\n'));
  rest_.remove_prefix(length);
  return token;
}

/// Of a line for the preprocessor, with those that continue it.
std::size_t IdlLexer::directiveLength() const {
  std::size_t end = rest_.find('\n');
  while (end != std::string_view::npos && rest_[end - 1] == '\\') end = rest_.find('\n', end + 1);
  return std::min(end, rest_.size());
}

void IdlLexer::skipBlanks() {
  while (!rest_.empty()) {
    std::size_t length = 0;
    if (std::isspace(static_cast<unsigned char>(rest_.front())) != 0) {
      length = 1;
    } else if (rest_.starts_with("//")) {
      length = std::min(rest_.find('\n'), rest_.size());
    } else if (rest_.starts_with("/*") && rest_.find("*/", 2) != std::string_view::npos) {
      length = rest_.find("*/", 2) + 2;
    } else if (rest_.starts_with('#') && isHarmless(rest_)) {
      length = directiveLength();
    } else {
      return;
    }
    (void)take(Token::Kind::kEnd, length);
  }
}

Token IdlLexer::read() {
  skipBlanks();
  if (rest_.empty()) return {Token::Kind::kEnd, rest_, line_};
  const char first = rest_.front();
  if (isLetter(first)) {
    return take(Token::Kind::kWord, lengthOf(rest_, [](char c) { return isLetter(c) || isDigit(c); }));
  }
  if (isDigit(first) || (first == '.' && rest_.size() > 1 && isDigit(rest_[1]))) {
    // With whatever is written to it: what is no number is refused whole. A sign may follow an exponent.
    const bool is_hex = rest_.starts_with("0x") || rest_.starts_with("0X");
    char before = 0;
    return take(Token::Kind::kNumber, lengthOf(rest_, [&before, is_hex](char c) {
                  const bool is_exponent_sign = !is_hex && (c == '+' || c == '-') && (before == 'e' || before == 'E');
                  before = c;
                  return isLetter(c) || isDigit(c) || c == '.' || is_exponent_sign;
                }));
  }
  if (first == '"' || first == '\'') return string(first);
  if (rest_.starts_with("/*")) return take(Token::Kind::kBad, rest_.size());
  if (rest_.starts_with("::")) return take(Token::Kind::kSign, 2);
  if (std::string_view("{}[]()<>;:,=@+-*/%|&^~").find(first) != std::string_view::npos)
    return take(Token::Kind::kSign, 1);
  if (first == '#') return take(Token::Kind::kDirective, directiveLength());
  return take(Token::Kind::kBad, 1);
}

/// What is escaped in it stays as it is written: of strings only units are shown, which have nothing to escape.
Token IdlLexer::string(char quote) {
  std::size_t end = 1;
  while (end < rest_.size() && rest_[end] != quote && rest_[end] != '\n') end += rest_[end] == '\\' ? 2 : 1;
  if (end >= rest_.size() || rest_[end] == '\n') return take(Token::Kind::kBad, std::min(end, rest_.size()));
  rest_.remove_prefix(1);
  const Token token = take(quote == '"' ? Token::Kind::kString : Token::Kind::kCharacter, end - 1);
  rest_.remove_prefix(1);
  return token;
}

bool IdlLexer::accept(std::string_view text) {
  if (!is(text)) return false;
  advance();
  return true;
}

bool IdlLexer::acceptTwice(std::string_view sign) {
  if (!is(sign) || !rest_.starts_with(sign)) return false;
  advance();
  advance();
  return true;
}

void IdlLexer::expect(std::string_view text) {
  if (!accept(text)) fail("'" + std::string(text) + "'");
}

bool isKeyword(std::string_view word) { return std::ranges::count(kKeywords, word) > 0; }

std::string_view unescaped(std::string_view word) {
  const bool is_escaped = word.size() > 1 && word.front() == '_' && word[1] != '_' && !isDigit(word[1]);
  return is_escaped ? word.substr(1) : word;
}

std::string IdlLexer::name(const std::string& what) {
  if (token_.kind != Token::Kind::kWord || isKeyword(token_.text)) fail(what);
  std::string name(unescaped(token_.text));
  advance();
  return name;
}

std::string IdlLexer::scopedName(const std::string& what) {
  std::string full = accept("::") ? "::" : "";
  full += name(what);
  while (accept("::")) {
    full += "::" + name("a name");
    if (full.size() > kMaxNameBytes) failBeyond(kMaxNameBytes, "bytes in a name");
  }
  return full;
}

void IdlLexer::skipTo(std::string_view end, std::string_view begin) {
  for (std::size_t open = 1; open > 0; advance()) {
    const Token::Kind kind = token_.kind;
    if (kind == Token::Kind::kEnd || kind == Token::Kind::kBad || (end == ")" && is(";"))) {
      fail("'" + std::string(end) + "'");
    }
    open += is(begin) ? 1 : 0;
    open -= is(end) ? 1 : 0;
  }
}

void IdlLexer::fail(const std::string& expected) const {
  const std::string_view text = token_.text.substr(0, 60);
  if (token_.kind == Token::Kind::kEnd) fail(expected, "the end of the text");
  if (token_.kind != Token::Kind::kBad) fail(expected, "'" + std::string(text) + "'");
  if (text.starts_with("/*")) fail(expected, "a comment without its end");
  if (text.front() == '"' || text.front() == '\'') fail(expected, "a string without its end on the line");
  const auto code = static_cast<unsigned char>(text.front());
  fail(expected, "a character that has no meaning in IDL (code " + std::to_string(code) + ")");
}

}  // namespace baton::schema
