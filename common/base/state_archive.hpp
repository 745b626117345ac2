/// The state of a part as bytes and back, from one list of its members: what is saved and what is restored cannot drift
/// apart. No pointers, no padding, host byte order; a checkpoint is read by the build that wrote it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "base/types.hpp"

namespace baton {

class StateArchive {
 public:
  /// Saves into `room`.
  [[nodiscard]] static StateArchive into(std::span<std::byte> room) noexcept {
    return {room.data(), nullptr, room.size(), false};
  }
  /// Restores from `saved`.
  [[nodiscard]] static StateArchive from(std::span<const std::byte> saved) noexcept {
    return {nullptr, saved.data(), saved.size(), true};
  }

  /// Numbers, flags and vectors, in the same order whether they are saved or restored. Once something does not fit,
  /// nothing more is touched. Never throws, never allocates.
  template <class... Members>
  void operator()(Members&... members) noexcept {
    (visit(members), ...);
  }

  /// What was restored cannot be.
  void fail() noexcept { is_good_ = false; }

  [[nodiscard]] bool isRestoring() const noexcept { return is_restoring_; }
  /// Everything fitted; when restoring, ask isWhole() in the end.
  [[nodiscard]] bool isGood() const noexcept { return is_good_; }
  /// Everything fitted and nothing is left over.
  [[nodiscard]] bool isWhole() const noexcept { return is_good_ && at_ == size_; }
  /// Bytes so far.
  [[nodiscard]] std::size_t size() const noexcept { return at_; }

 private:
  StateArchive(std::byte* to, const std::byte* from, std::size_t size, bool is_restoring) noexcept
      : to_(to), from_(from), size_(size), is_restoring_(is_restoring) {}

  void bytes(void* member, std::size_t count) noexcept {
    if (!is_good_ || count > size_ - at_) {
      is_good_ = false;
      return;
    }
    if (isRestoring()) {
      std::memcpy(member, from_ + at_, count);
    } else {
      std::memcpy(to_ + at_, member, count);
    }
    at_ += count;
  }

  template <class Number>
  requires std::is_arithmetic_v<Number>
  void visit(Number& number) noexcept { bytes(&number, sizeof number); }

  /// A byte that is neither 0 nor 1 is refused: no flag can have it.
  void visit(bool& flag) noexcept {
    auto value = static_cast<std::uint8_t>(flag);
    visit(value);
    if (value > 1) return fail();
    flag = value == 1;
  }

  /// Size, then entries. A size that the vector cannot have is refused.
  template <int kRows, int kMaxRows>
  void visit(Eigen::Matrix<double, kRows, 1, Eigen::ColMajor, kMaxRows, 1>& vector) noexcept {
    static_assert(kMaxRows != Eigen::Dynamic, "only vectors with inline storage");
    auto rows = static_cast<std::uint32_t>(vector.size());
    visit(rows);
    const bool fits = kRows == Eigen::Dynamic ? std::cmp_less_equal(rows, kMaxRows) : std::cmp_equal(rows, kRows);
    if (!is_good_ || !fits) {
      is_good_ = false;
      return;
    }
    if constexpr (kRows == Eigen::Dynamic) vector.resize(rows);
    bytes(vector.data(), rows * sizeof(double));
  }

  std::byte* to_;
  const std::byte* from_;
  std::size_t size_;
  bool is_restoring_;  // a room without bytes has no address either
  std::size_t at_ = 0;
  bool is_good_ = true;
};

}  // namespace baton
