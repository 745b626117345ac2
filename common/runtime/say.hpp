/// All that programs print for people, and the one place that knows a terminal: names and texts of others may come with
/// what would clear it, hide lines, begin lines of their own or type for the reader. Control characters and what is not
/// UTF-8 are shown escaped, as base/text.hpp does.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/text.hpp"

namespace baton {

/// Line breaks stay: for text of several lines. Names of others within it are escaped() before.
void sayText(std::string_view text, std::FILE* out = stdout);

// As printf and fprintf; line breaks stay in the values, too.
void say(const char* format, ...) __attribute__((format(printf, 1, 2)));
void say(std::FILE* out, const char* format, ...) __attribute__((format(printf, 2, 3)));

/// Text without its line breaks, and what else there is as it is.
template <class Value>
decltype(auto) withinLine(const Value& value) {
  if constexpr (std::is_convertible_v<const Value&, std::string_view>) {
    return escaped(value);
  } else {
    return (value);
  }
}

/// As fmt::print. A value that is text stays within its line.
template <class... Values>
void sayf(fmt::format_string<Values...> format, const Values&... values) {
  const auto print = [&](const auto&... all) { sayText(fmt::vformat(format, fmt::make_format_args(all...))); };
  print(withinLine(values)...);
}

/// One line on standard error.
void sayWarning(std::string_view text);

/// As it is, on standard output: for the text of a format that knows how to escape. Whether it could be written.
[[nodiscard]] bool sayRaw(std::string_view text);

/// Writes out what is still held back of standard output. Returns why what was printed has not all arrived, as "No
/// space left on device"; nothing when it has, or when whoever reads it had enough.
std::string flushSaid();

}  // namespace baton
