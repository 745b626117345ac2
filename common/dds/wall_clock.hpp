/// The wall clock of a run, for the time stamps of what is sent and recorded: read once, and continued by the steady
/// clock. A clock that is set while a run lasts, by hand or by NTP, neither tears a hole into its recording nor makes
/// its times stand still. The processes of a run share the offset, so that the samples of one that is started later
/// are stamped on the same scale; it holds for one machine, where all processes have the same steady clock. Time in
/// which the machine is suspended does not count.
#pragma once

#include <chrono>
#include <cstdint>

namespace baton::dds {

template <class Wall, class Steady>
class BasicWallClock {
 public:
  /// Reads the wall clock.
  BasicWallClock() : offset_ns_(count<Wall>() - count<Steady>()) {}
  /// @param offset_ns  of another process's clock on this machine.
  explicit BasicWallClock(std::int64_t offset_ns) : offset_ns_(offset_ns) {}

  /// ns since 1970.
  [[nodiscard]] std::int64_t now() const noexcept { return offset_ns_ + count<Steady>(); }
  /// From the steady clock to this one [ns].
  [[nodiscard]] std::int64_t offset() const noexcept { return offset_ns_; }
  bool operator==(const BasicWallClock&) const = default;

 private:
  template <class Clock>
  static std::int64_t count() noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
  }

  std::int64_t offset_ns_;
};

using WallClock = BasicWallClock<std::chrono::system_clock, std::chrono::steady_clock>;

}  // namespace baton::dds
