#include "runtime/say.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <string>

#include "base/text.hpp"

namespace baton {
namespace {

int output_error = 0;  // errno of standard output

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
  if (out == stdout) {
    (void)sayRaw(shown);  // flushSaid() tells
  } else {
    std::fwrite(shown.data(), 1, shown.size(), out);
  }
}

bool sayRaw(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) return true;
  output_error = errno;
  return false;
}

std::string flushSaid() {
  errno = 0;
  if (std::fflush(stdout) != 0) output_error = errno;
  if (output_error == EPIPE) return "";
  if (output_error != 0) return std::strerror(output_error);
  // What CLI11 prints goes another way, and its reason is lost.
  pollfd end{.fd = STDOUT_FILENO, .events = 0, .revents = 0};
  const bool has_reader = poll(&end, 1, 0) <= 0 || (end.revents & POLLERR) == 0;
  return std::ferror(stdout) != 0 && has_reader ? "some of it could not be written" : "";
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
