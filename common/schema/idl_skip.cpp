#include "schema/idl_skip.hpp"

#include <cstddef>
#include <string_view>

namespace baton::schema {

std::vector<std::string> skipDefinition(IdlLexer& lexer) {
  std::vector<std::string> names;
  bool is_typedef = false;
  std::size_t within = 0, braces = 0;  // of any kind; of these alone
  std::string_view word;
  for (bool is_first = true;; is_first = false) {
    const Token token = lexer.token();
    const bool ends = lexer.is(";") && braces == 0;
    if (lexer.acceptTwice("<")) continue;  // a shift
    if (token.kind == Token::Kind::kEnd || (lexer.is("}") && braces == 0 && !is_first)) return names;
    is_typedef = is_typedef || (within == 0 && lexer.is("typedef"));
    const auto isOneOf = [&](std::string_view signs) {
      return token.kind == Token::Kind::kSign && token.text.size() == 1 && signs.find(token.text) != signs.npos;
    };
    const bool is_first_name = names.empty() && (isOneOf("{:;=") || lexer.is("switch"));
    const bool is_declared = is_first_name || (is_typedef && isOneOf(",;["));
    if (within == 0 && is_declared && !word.empty()) names.emplace_back(word);
    if (isOneOf("{([<")) ++within;
    if (isOneOf("})]>") && within > 0) --within;
    braces += lexer.is("{") ? 1 : 0;
    braces -= lexer.is("}") && braces > 0 ? 1 : 0;
    word = token.kind == Token::Kind::kWord ? unescaped(token.text) : "";
    lexer.advance();
    if (ends) return names;
  }
}

}  // namespace baton::schema
