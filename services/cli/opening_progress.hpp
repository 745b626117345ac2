/// "reading run.mcap 42 %" on the terminal, while a large recording is being opened.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "runtime/progress_line.hpp"

namespace baton {

/// What to show of it: nothing of a file that opens at once.
class OpeningText {
 public:
  using Clock = std::chrono::steady_clock;

  /// Empty: nothing. Counts from the first call for a file on; done == of is the end of it.
  [[nodiscard]] std::string at(Clock::time_point now, const std::filesystem::path& file, std::uint64_t done,
                               std::uint64_t of) {
    constexpr std::chrono::seconds kPatience{2};
    if (file != file_) begun_.reset();
    file_ = file;
    if (done >= of) {
      begun_.reset();
      return "";
    }
    if (!begun_) begun_ = now;
    if (now - *begun_ < kPatience) return "";
    const double percent = 100.0 * static_cast<double>(done) / static_cast<double>(of);
    return "reading " + file.string() + " " + std::to_string(static_cast<unsigned>(percent)) + " %";
  }

 private:
  std::filesystem::path file_;
  std::optional<Clock::time_point> begun_;
};

/// Shows it; threads may open files at the same time. Nothing is left on the line when a file is open.
class OpeningProgress {
 public:
  void operator()(const std::filesystem::path& file, std::uint64_t done, std::uint64_t of) {
    const std::lock_guard lock(mutex_);
    const std::string text = text_.at(OpeningText::Clock::now(), file, done, of);
    if (text.empty()) {
      line_.clear();
    } else {
      line_.show(text);
    }
  }

 private:
  std::mutex mutex_;
  OpeningText text_;
  ProgressLine line_;
};

}  // namespace baton
