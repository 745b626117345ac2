// The clock of a run: wall time that no setting of the wall clock moves.
#include "dds/wall_clock.hpp"

#include <gtest/gtest.h>

namespace baton::dds {
namespace {

/// A clock that says what it is told.
template <int kWhich>
struct SetClock {
  using time_point = std::chrono::time_point<std::chrono::system_clock, std::chrono::nanoseconds>;
  static inline std::int64_t time_ns = 0;
  static time_point now() { return time_point(std::chrono::nanoseconds(time_ns)); }
};
using Wall = SetClock<0>;
using Steady = SetClock<1>;
using Clock = BasicWallClock<Wall, Steady>;

constexpr std::int64_t kHour_ns = 3'600'000'000'000;

TEST(WallClock, GoesOnWithTheSteadyClockWhenTheWallClockIsSet) {
  Wall::time_ns = 1'700'000'000'000'000'000;
  Steady::time_ns = 5'000;
  const Clock clock;
  EXPECT_EQ(clock.now(), Wall::time_ns);
  for (const std::int64_t jump_ns : {kHour_ns, -2 * kHour_ns, std::int64_t{-10'000'000'000}}) {
    Wall::time_ns += jump_ns;
    Steady::time_ns += 1'000;
    EXPECT_EQ(clock.now(), 1'700'000'000'000'000'000 + Steady::time_ns - 5'000);
  }
}

TEST(WallClock, AProcessThatJoinsLaterCountsTheSameTime) {
  Wall::time_ns = 1'700'000'000'000'000'000;
  Steady::time_ns = 5'000;
  const Clock first;
  Wall::time_ns += kHour_ns;
  Steady::time_ns += 7'000;
  const Clock joined(first.offset());
  EXPECT_EQ(joined.now(), first.now());
  EXPECT_NE(Clock().now(), first.now());
}

}  // namespace
}  // namespace baton::dds
