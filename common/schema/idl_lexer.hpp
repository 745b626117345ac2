/// IDL text as words, numbers, strings and signs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace baton::schema {

struct Token {
  enum class Kind {
    kWord,
    kNumber,
    kString,
    kCharacter,
    kSign,
    kDirective,  // a line for the preprocessor that may change what is read
    kBad,        // no part of IDL
    kEnd
  };
  Kind kind = Kind::kEnd;
  std::string_view text{};  // of a string or a character without its quotes
  std::size_t line = 1;
};

/// "line 3: expected ';', found 'struct'", thrown as IdlError.
[[noreturn]] void failAt(std::size_t line, const std::string& expected, const std::string& found);

[[nodiscard]] bool isKeyword(std::string_view word);
/// A name without the '_' that keeps it from being taken for a keyword: "_struct" is called struct.
[[nodiscard]] std::string_view unescaped(std::string_view word);

/// Cuts a text into tokens and hands them out one by one; white space, comments, #pragma and line marks are skipped.
/// Throws IdlError for what is not expected. A copy goes on where the original was.
class IdlLexer {
 public:
  explicit IdlLexer(std::string_view text) : rest_(text) { advance(); }

  /// The next token; kEnd at the end.
  [[nodiscard]] const Token& token() const { return token_; }
  void advance() { token_ = read(); }

  /// Whether this word or sign comes next.
  [[nodiscard]] bool is(std::string_view text) const {
    return (token_.kind == Token::Kind::kWord || token_.kind == Token::Kind::kSign) && token_.text == text;
  }
  /// Takes it if it does.
  bool accept(std::string_view text);
  /// Takes "<<" or ">>", of whose sign two stand side by side.
  bool acceptTwice(std::string_view sign);
  /// Takes it.
  void expect(std::string_view text);
  /// Takes a word that is not a keyword; returned without what escapes it.
  [[nodiscard]] std::string name(const std::string& what);
  /// Takes "a::b" or "::a::b"; returned in this form.
  [[nodiscard]] std::string scopedName(const std::string& what);

  /// Takes all up to the end of what was opened, with all that is opened within.
  void skipTo(std::string_view end, std::string_view begin);

  [[noreturn]] void fail(const std::string& expected) const;
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    failAt(token_.line, expected, found);
  }
  /// "expected at most 32 modules within each other, found more"
  [[noreturn]] void failBeyond(std::uint64_t limit, const std::string& what) const {
    fail("at most " + std::to_string(limit) + " " + what, "more");
  }

 private:
  void skipBlanks();
  [[nodiscard]] Token take(Token::Kind kind, std::size_t length);
  [[nodiscard]] std::size_t directiveLength() const;
  [[nodiscard]] Token string(char quote);
  [[nodiscard]] Token read();

  std::string_view rest_;
  std::size_t line_ = 1;
  Token token_{};
};

}  // namespace baton::schema
