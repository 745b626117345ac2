/// Deadlines on the wall clock: absolute, free of drift, and never in a rush to catch up.
#include "time/pacer.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace baton {
namespace {

constexpr std::int64_t kStep_ns = 500'000;

TEST(Pacer, DeadlinesAreCountedFromTheAnchor) {
  Pacer pacer(kStep_ns, 1.0);
  pacer.anchor(0, 1'000);
  EXPECT_EQ(pacer.deadline(0), 1'000);
  EXPECT_EQ(pacer.deadline(1), 1'000 + kStep_ns);
  EXPECT_EQ(pacer.deadline(17), 1'000 + 17 * kStep_ns);
}

TEST(Pacer, AStepIsDueFromItsDeadlineOn) {
  Pacer pacer(kStep_ns, 1.0);
  pacer.anchor(0, 0);
  EXPECT_FALSE(pacer.isDue(3, 3 * kStep_ns - 1));
  EXPECT_TRUE(pacer.isDue(3, 3 * kStep_ns));
  EXPECT_TRUE(pacer.isDue(3, 3 * kStep_ns + 1));
}

TEST(Pacer, LatenessOfOneStepDoesNotMoveTheNext) {
  // Asking late, often or not at all changes nothing: a deadline depends on the step alone.
  Pacer pacer(kStep_ns, 1.0);
  pacer.anchor(0, 0);
  EXPECT_TRUE(pacer.isDue(1, 40 * kStep_ns));
  EXPECT_EQ(pacer.deadline(2), 2 * kStep_ns);
}

TEST(Pacer, DoesNotDriftInTenMillionSteps) {
  constexpr std::int64_t kAnchor_ns = 123'456'789'012'345;  // 1.4 days of uptime
  Pacer pacer(kStep_ns, 1.0);
  pacer.anchor(0, kAnchor_ns);
  std::int64_t before = kAnchor_ns;
  for (std::uint64_t step = 1; step <= 10'000'000; ++step) {
    const std::int64_t due = *pacer.deadline(step);
    // step x step_ns stays below 2^53, so the product is exact at rate 1.
    ASSERT_EQ(due - before, kStep_ns) << step;
    before = due;
  }
}

TEST(Pacer, AFactorOfRealTimeDividesTheDeadlines) {
  for (const double rate : {0.1, 0.5, 2.0, 3.0, 7.0}) {
    Pacer pacer(kStep_ns, rate);
    pacer.anchor(0, 0);
    for (const std::uint64_t step : {1ull, 1'000ull, 9'999'999ull}) {
      // Rounded to the nanosecond once, not once a step.
      const long double exact = static_cast<long double>(step) * kStep_ns / static_cast<long double>(rate);
      EXPECT_NEAR(static_cast<long double>(*pacer.deadline(step)), exact, 1.0L) << rate << " " << step;
    }
  }
}

TEST(Pacer, ChangeOfRateStartsFromHere) {
  Pacer pacer(kStep_ns, 1.0);
  pacer.anchor(0, 0);
  pacer.setRate(4.0, 100, 70'000'000);  // 20 ms behind
  EXPECT_EQ(pacer.rate(), 4.0);
  EXPECT_EQ(pacer.deadline(100), 70'000'000);
  EXPECT_EQ(pacer.deadline(108), 70'000'000 + 2 * kStep_ns);
}

TEST(Pacer, TimeSpentInAPauseIsNotCaughtUp) {
  Pacer pacer(kStep_ns, 1.0);
  pacer.anchor(0, 0);
  const std::int64_t resumed_ns = 3'600'000'000'000;
  pacer.anchor(50, resumed_ns);
  EXPECT_FALSE(pacer.isDue(51, resumed_ns));
  EXPECT_EQ(pacer.deadline(51), resumed_ns + kStep_ns);
}

TEST(Pacer, AStallIsForgivenAndASmallDelayCaughtUp) {
  constexpr std::int64_t kLimit_ns = 5 * kStep_ns;
  Pacer pacer(kStep_ns, 1.0);
  pacer.anchor(0, 0);
  pacer.forgive(10, 10 * kStep_ns + kLimit_ns, kLimit_ns);
  EXPECT_EQ(pacer.deadline(11), 11 * kStep_ns) << "within the limit the schedule stays";
  const std::int64_t late_ns = 10 * kStep_ns + kLimit_ns + 1;
  pacer.forgive(10, late_ns, kLimit_ns);
  EXPECT_EQ(pacer.deadline(11), late_ns + kStep_ns) << "after a stall it goes on at its rate from there";
}

TEST(Pacer, TellsWhichStepIsDue) {
  Pacer pacer(kStep_ns, 2.0);
  pacer.anchor(100, 1'000);
  EXPECT_EQ(pacer.stepAt(0), 100U) << "before the anchor";
  for (const std::uint64_t step : {100ull, 101ull, 7'777ull}) {
    EXPECT_EQ(pacer.stepAt(*pacer.deadline(step)), step);
    EXPECT_EQ(pacer.stepAt(*pacer.deadline(step + 1) - 1), step);
  }
  pacer.setRate(0.0, 200, 5'000);
  EXPECT_EQ(pacer.stepAt(1'000'000'000), 200U) << "without pacing no step has its time";
}

TEST(Pacer, RateZeroNeverWaits) {
  Pacer pacer(kStep_ns, 0.0);
  pacer.anchor(0, 1'000'000'000);
  EXPECT_FALSE(pacer.deadline(1'000'000));
  EXPECT_TRUE(pacer.isDue(1'000'000, 0));
  pacer.setRate(1.0, 10, 0);
  EXPECT_FALSE(pacer.isDue(11, 0));
  pacer.setRate(0.0, 10, 0);
  EXPECT_TRUE(pacer.isDue(11, 0));
}

}  // namespace
}  // namespace baton
