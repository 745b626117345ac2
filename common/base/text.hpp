/// Checks of text from files, command lines and samples, before it is shown or used.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace baton {

[[nodiscard]] inline bool isControlCharacter(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

[[nodiscard]] inline bool hasControlCharacters(std::string_view text) {
  return std::ranges::any_of(text, isControlCharacter);
}

/// Fit for a terminal and for one line: each control character is a space.
[[nodiscard]] inline std::string printable(std::string_view text) {
  std::string result(text);
  std::ranges::replace_if(result, isControlCharacter, ' ');
  return result;
}

/// Fit for a terminal and for one line, and still told from other text: \n, \x1b and \u009b for control characters,
/// \xff for bytes that are not UTF-8. Line breaks stay where they are wanted.
[[nodiscard]] std::string escaped(std::string_view text, bool keeps_lines = false);

/// A file name without a folder that ends in `ending` (".mcap") and has at least one character before it.
[[nodiscard]] inline bool isFileName(std::string_view name, std::string_view ending) {
  return name.size() > ending.size() && name.ends_with(ending) && name.front() != '.' &&
         name.find('/') == std::string_view::npos && !hasControlCharacters(name);
}

}  // namespace baton
