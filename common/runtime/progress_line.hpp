/// One line on the terminal that is written over, nothing when standard error is a file; and a bar to stand in it.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "base/text.hpp"

namespace baton {

/// "[######..................]" for a part from 0 to 1.
[[nodiscard]] inline std::string progressBar(double part) {
  constexpr int kWidth = 24;
  const int filled = part > 0.0 ? static_cast<int>(std::min(part, 1.0) * kWidth) : 0;  // NaN is nothing done
  return "[" + std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(kWidth - filled), '.') + "]";
}

class ProgressLine {
 public:
  ProgressLine() = default;
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Makes room for other text.
  void clear() {
    if (!last_.empty()) std::fprintf(stderr, "\r\033[K");
    last_.clear();
  }
  void show(const std::string& text) {
    if (!is_terminal_ || text == last_) return;
    std::fprintf(stderr, "\r\033[K%s", escaped(text).c_str());
    last_ = text;
  }

 private:
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  std::string last_;
};

}  // namespace baton
