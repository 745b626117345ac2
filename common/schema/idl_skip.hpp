/// Passing over a definition of an IDL text that cannot be used.
#pragma once

#include <string>
#include <vector>

#include "schema/idl_lexer.hpp"

namespace baton::schema {

/// Up to the ';' behind it, or to the '}' around it. Returns the names it declares: the one before its body, its
/// base, its value or its end, and in a typedef those before ',', ';' or '['.
[[nodiscard]] std::vector<std::string> skipDefinition(IdlLexer& lexer);

}  // namespace baton::schema
