/// The room that a recording has on its disk: before each sample it continues in this part, in another one, without its
/// oldest, or ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "recording.hpp"
#include "storage_policy.hpp"

namespace baton {

class Room {
 public:
  /// `config` outlives it. @param names  of the limits, as whoever set them calls them.
  explicit Room(const RecordingConfig& config, LimitNames names = {}) : config_(config), names_(names) {}

  /// Whether anything has to be looked after: the disk, a budget, parts.
  [[nodiscard]] bool isLimited() const {
    return config_.isSplit() || config_.max_bytes > 0 || config_.min_free_bytes > 0;
  }
  /// How much is left on the disk of this file: measured now, and as measured last.
  void measure(const std::filesystem::path& file);
  [[nodiscard]] std::uint64_t freeBytes() const { return free_bytes_; }

  struct Outcome {
    bool has_dropped = false;  // the oldest part
    bool is_disk_low = false;
    std::string end{};  // why the recording has to end; empty: it continues
  };
  /// Before a sample is written. @param elapsed, step  as Recording::splitWhenFull() has them. Throws WriteError.
  [[nodiscard]] Outcome makeFor(Recording& recording, std::uint64_t elapsed, std::uint64_t step);

 private:
  const RecordingConfig& config_;
  LimitNames names_;
  std::uint64_t free_bytes_ = 0;
  std::uint64_t measured_bytes_ = 0;  // of the recording when the disk was last looked at
};

}  // namespace baton
