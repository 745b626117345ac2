/// One line on the terminal that is written over; nothing when standard error is a file.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>

namespace baton {

class ProgressLine {
 public:
  ProgressLine() = default;
  ~ProgressLine() {
    if (!last_.empty()) std::fprintf(stderr, "\r\033[K");
  }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const std::string& text) {
    if (!is_terminal_ || text == last_) return;
    std::fprintf(stderr, "\r\033[K%s", text.c_str());
    last_ = text;
  }

 private:
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  std::string last_;
};

}  // namespace baton
