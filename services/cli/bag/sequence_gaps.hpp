/// Sequence numbers that are missing between the first and the last of one writer, in whatever order its messages lie
/// in a file.
#pragma once

#include <cstdint>
#include <iterator>
#include <map>

namespace baton {

class SequenceGaps {
 public:
  /// @param sequence  the low half of the writer's number, as the file has it: it may wrap.
  void add(std::uint32_t sequence) {
    const std::int64_t at = latest_ + static_cast<std::int32_t>(sequence - static_cast<std::uint32_t>(latest_));
    if (is_empty_) {
      first_ = last_ = at;
      is_empty_ = false;
    } else if (at > last_) {
      open(last_ + 1, at);
      last_ = at;
    } else if (at < first_) {
      open(at + 1, first_);
      first_ = at;
    } else {
      fill(at);
    }
    latest_ = at;
  }
  [[nodiscard]] std::uint64_t missing() const { return missing_; }

 private:
  void open(std::int64_t begin, std::int64_t end) {
    if (begin == end) return;
    holes_[begin] = end;
    missing_ += static_cast<std::uint64_t>(end - begin);
  }
  void fill(std::int64_t at) {
    auto hole = holes_.upper_bound(at);
    if (hole == holes_.begin() || (--hole)->second <= at) return;  // it is in the file twice
    const auto [begin, end] = *hole;
    holes_.erase(hole);
    missing_ -= static_cast<std::uint64_t>(end - begin);
    open(begin, at);
    open(at + 1, end);
  }

  bool is_empty_ = true;
  std::int64_t first_ = 0;
  std::int64_t last_ = 0;
  std::int64_t latest_ = 0;                       // in the order of the file
  std::map<std::int64_t, std::int64_t> holes_{};  // from, to
  std::uint64_t missing_ = 0;
};

}  // namespace baton
