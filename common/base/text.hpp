/// Checks of text from files, command lines and samples, before it is shown or used.
#pragma once

#include <string>
#include <string_view>

namespace baton {

/// Fit for a terminal and for one line, and still told from other text: \n, \x1b and \u009b for control characters,
/// \xff for bytes that are not UTF-8. Line breaks stay where they are wanted.
[[nodiscard]] std::string escaped(std::string_view text, bool keeps_lines = false);

/// Whether it is shown as it is: UTF-8 without control characters.
[[nodiscard]] inline bool isPlain(std::string_view text) { return escaped(text) == text; }

/// JSON text in UTF-8 with what JSON lets stand and a terminal may obey as escapes of JSON: \u007f to \u009f.
[[nodiscard]] std::string escapedInJson(std::string text);

/// A file name without a folder that ends in `ending` (".mcap") and has at least one character before it.
[[nodiscard]] inline bool isFileName(std::string_view name, std::string_view ending) {
  return name.size() > ending.size() && name.ends_with(ending) && name.front() != '.' &&
         name.find('/') == std::string_view::npos && isPlain(name);
}

}  // namespace baton
