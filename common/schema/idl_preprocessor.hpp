/// What a preprocessor does to an IDL text, as far as recorded texts need it: parts that are left out, and names that
/// are defined.
#pragma once

#include <string>
#include <string_view>

namespace baton::schema {

/// The text with its lines where they were: without a byte order mark, without what #if 0, #if 1, #ifdef, #ifndef,
/// #if defined(NAME), #else and #endif leave out, and with the meaning of each `#define NAME meaning` in the place of
/// NAME. A name that the text does not define is not defined. Other lines for a preprocessor stay, conditions of
/// another form with all that is in them. Throws IdlError for a text that grows beyond limits.hpp.
[[nodiscard]] std::string preprocessed(std::string_view text);

}  // namespace baton::schema
