#include "runtime/say.hpp"

#include <algorithm>
#include <cstdarg>
#include <string>

#include "base/text.hpp"

namespace baton {
namespace {

void sayFormatted(std::FILE* out, const char* format, std::va_list values) {
  std::va_list again;
  va_copy(again, values);
  const int length = std::vsnprintf(nullptr, 0, format, values);
  std::string text(static_cast<std::size_t>(std::max(length, 0)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  sayText(text, out);
}

}  // namespace

void sayText(std::string_view text, std::FILE* out) {
  const std::string shown = escaped(text, true);
  std::fwrite(shown.data(), 1, shown.size(), out);
}

void sayWarning(std::string_view text) { sayText("baton: warning: " + escaped(text) + '\n', stderr); }

void say(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  sayFormatted(stdout, format, values);
  va_end(values);
}

void say(std::FILE* out, const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  sayFormatted(out, format, values);
  va_end(values);
}

}  // namespace baton
