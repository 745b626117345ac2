/// All that programs print for people, and the one place that knows a terminal: names and texts of others may come with
/// what would clear it, hide lines or type for the reader. Control characters and what is not UTF-8 are shown escaped,
/// as base/text.hpp does; line breaks stay.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <string_view>
#include <utility>

namespace baton {

void sayText(std::string_view text, std::FILE* out = stdout);

// As printf, fprintf and fmt::print.
void say(const char* format, ...) __attribute__((format(printf, 1, 2)));
void say(std::FILE* out, const char* format, ...) __attribute__((format(printf, 2, 3)));
template <class... Values>
void sayf(fmt::format_string<Values...> format, Values&&... values) {
  sayText(fmt::format(format, std::forward<Values>(values)...));
}

}  // namespace baton
