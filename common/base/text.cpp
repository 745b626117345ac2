#include "base/text.hpp"

#include <cstdio>

namespace baton {
namespace {

/// Bytes of the UTF-8 character that the text begins with; 0 when it begins with none.
std::size_t characterBytes(std::string_view text) {
  const auto at = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned first = at(0), second = at(1);
  const std::size_t size = first < 0x80   ? 1
                           : first < 0xc2 ? 0
                           : first < 0xe0 ? 2
                           : first < 0xf0 ? 3
                           : first < 0xf5 ? 4
                                          : 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((at(i) & 0xc0U) != 0x80) return 0;
  }
  // Longer than need be, half of a pair, or beyond the last one.
  const bool is_none = (first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) ||
                       (first == 0xf0 && second < 0x90) || (first == 0xf4 && second >= 0x90);
  return is_none ? 0 : size;
}

constexpr unsigned char kDelete = 0x7f;

/// Whether it begins with U+0080 to U+009F: controls as well, which some terminals take as ESC and a letter.
bool isC1(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  return text.size() > 1 && at(0) == 0xc2 && at(1) >= 0x80 && at(1) < 0xa0;
}

void append(std::string& out, const char* format, unsigned value) {
  char text[16];
  std::snprintf(text, sizeof text, format, value);
  out += text;
}

}  // namespace

std::string escaped(std::string_view text, bool keeps_lines) {
  std::string result;
  for (std::size_t size = 0; !text.empty(); text.remove_prefix(size)) {
    size = characterBytes(text);
    const auto first = static_cast<unsigned char>(text[0]);
    if (first == '\n') {
      result += keeps_lines ? "\n" : "\\n";
    } else if (size == 0 || first < 0x20 || first == kDelete) {
      append(result, "\\x%02x", first);
      size = 1;
    } else if (isC1(text)) {
      append(result, "\\u%04x", static_cast<unsigned char>(text[1]));
    } else {
      result += text.substr(0, size);
    }
  }
  return result;
}

std::string escapedInJson(std::string text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::size_t size = isC1(std::string_view(text).substr(at)) ? 2 : text[at] == kDelete ? 1 : 0;
    if (size == 0) continue;
    std::string escape;
    append(escape, "\\u%04x", static_cast<unsigned char>(text[at + size - 1]));
    text.replace(at, size, escape);
  }
  return text;
}

}  // namespace baton
