/// When messages go out, whatever is asked for: fed by hand, with a clock of the test's own.
#include "playback.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::uint64_t kStart = 1'700'000'000'000'000'000;  // log times are of this kind
constexpr std::int64_t kNow = 5'000'000'000;

std::uint64_t at(std::int64_t ms) { return kStart + static_cast<std::uint64_t>(ms * kMs); }

/// A replay that has begun with a message at 0 ms, which has gone out.
Playback begun(const Playback::Plan& plan = {}) {
  Playback playback(plan);
  playback.begin(at(0), kNow);
  playback.sent("a", at(0), kNow);
  return playback;
}

TEST(Playback, TheFirstMessageIsDueAtOnceAndTheNextAtItsDistance) {
  Playback playback({.rate = 2.0});
  playback.begin(at(0), kNow);
  EXPECT_EQ(playback.due(at(0)).deadline_ns, kNow);
  playback.sent("a", at(0), kNow + 7);  // late: the next is not
  EXPECT_EQ(playback.due(at(10)).deadline_ns, kNow + 5 * kMs);
  EXPECT_FALSE(playback.due(at(10)).is_held);
}

TEST(Playback, AsFastAsPossibleThereAreNoDeadlines) {
  Playback playback = begun({.rate = 0.0});
  EXPECT_FALSE(playback.due(at(1000)).is_held);
  EXPECT_FALSE(playback.due(at(1000)).deadline_ns);
}

TEST(Playback, APauseHoldsAndWhatWasLeftOfTheWaitIsWaitedForAfterIt) {
  Playback playback = begun();
  EXPECT_EQ(playback.due(at(10)).deadline_ns, kNow + 10 * kMs);
  playback.pause(kNow + 4 * kMs);
  EXPECT_TRUE(playback.due(at(10)).is_held);
  EXPECT_EQ(playback.position(kNow + 400 * kMs), at(4)) << "it stands still";
  playback.resume(kNow + 1000 * kMs);
  EXPECT_EQ(playback.due(at(10)).deadline_ns, kNow + 1006 * kMs);
}

TEST(Playback, AGapIsWaitedForNoLongerThanAsked) {
  Playback playback = begun({.longest_gap_ns = 500'000'000});
  EXPECT_EQ(playback.due(at(400)).deadline_ns, kNow + 400 * kMs) << "a shorter one is kept";
  playback.sent("a", at(400), kNow + 400 * kMs);
  for (int ask = 0; ask < 3; ++ask) EXPECT_EQ(playback.due(at(3'600'400)).deadline_ns, kNow + 900 * kMs);
  EXPECT_EQ(playback.position(kNow + 600 * kMs), at(3'600'100)) << "from the gap's end";
  playback.sent("a", at(3'600'400), kNow + 900 * kMs);
  EXPECT_EQ(playback.due(at(3'600'410)).deadline_ns, kNow + 910 * kMs);
  EXPECT_EQ(playback.playedTime(), 900'000'000U);
}

TEST(Playback, AGapThatIsCutShortKeepsWhatWasLeftOfItOverAPause) {
  Playback playback = begun({.rate = 2.0, .longest_gap_ns = 1'000'000'000});
  EXPECT_EQ(playback.due(at(3'600'000)).deadline_ns, kNow + 500 * kMs);
  playback.pause(kNow + 100 * kMs);
  EXPECT_TRUE(playback.due(at(3'600'000)).is_held);
  playback.resume(kNow + 5000 * kMs);
  EXPECT_EQ(playback.due(at(3'600'000)).deadline_ns, kNow + 5400 * kMs);
}

TEST(Playback, AGapIsWaitedForNoLongerThanAskedAfterASeekToo) {
  Playback playback = begun({.longest_gap_ns = 500'000'000});
  playback.seek(at(1000), kNow);
  EXPECT_EQ(playback.due(at(1400)).deadline_ns, kNow + 400 * kMs) << "a shorter one is kept";
  playback.seek(at(1000), kNow + 100 * kMs);
  for (int ask = 0; ask < 3; ++ask) EXPECT_EQ(playback.due(at(3'601'000)).deadline_ns, kNow + 600 * kMs);
  EXPECT_EQ(playback.position(kNow + 200 * kMs), at(3'600'600)) << "from the gap's end";
  playback.pause(kNow + 200 * kMs);
  EXPECT_TRUE(playback.due(at(3'601'000)).is_held);
  playback.resume(kNow + 5000 * kMs);
  EXPECT_EQ(playback.due(at(3'601'000)).deadline_ns, kNow + 5400 * kMs) << "what was left of it";
  playback.sent("a", at(3'601'000), kNow + 5400 * kMs);
  EXPECT_EQ(playback.playedTime(), 0U) << "the gap was skipped to";
}

TEST(Playback, AGapIsWaitedForNoLongerThanAskedAfterASeekInAPause) {
  Playback playback = begun({.longest_gap_ns = 500'000'000});
  playback.pause(kNow);
  playback.seek(at(1000), kNow + 100 * kMs);
  EXPECT_TRUE(playback.due(at(3'601'000)).is_held);
  playback.resume(kNow + 1000 * kMs);
  EXPECT_EQ(playback.due(at(3'601'000)).deadline_ns, kNow + 1500 * kMs);
}

TEST(Playback, CanBeginPaused) {
  Playback playback({.starts_paused = true});
  playback.begin(at(0), kNow);
  EXPECT_TRUE(playback.due(at(0)).is_held);
  playback.resume(kNow + 50 * kMs);
  EXPECT_EQ(playback.due(at(0)).deadline_ns, kNow + 50 * kMs);
}

TEST(Playback, AStepLetsExactlySoManyGo) {
  Playback playback = begun();
  playback.step(3, "", kNow);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_FALSE(playback.due(at(10 * i)).is_held) << i;
    EXPECT_FALSE(playback.due(at(10 * i)).deadline_ns) << "at once";
    playback.sent("a", at(10 * i), kNow);
  }
  EXPECT_TRUE(playback.due(at(40)).is_held);
  EXPECT_FALSE(playback.isPlaying());
  EXPECT_EQ(playback.position(kNow), at(30));
}

TEST(Playback, AStepOfATopicTakesTheOthersAlong) {
  Playback playback = begun();
  playback.step(2, "state", kNow);
  for (const char* topic : {"a", "state", "a", "a"}) {
    EXPECT_FALSE(playback.due(at(1)).is_held);
    playback.sent(topic, at(1), kNow);
  }
  EXPECT_EQ(playback.stepsLeft(), 1U);
  playback.sent("state", at(1), kNow);
  EXPECT_TRUE(playback.due(at(2)).is_held);
}

TEST(Playback, WhateverInterruptsAStepEndsIt) {
  const auto stepping = [] {
    Playback playback = begun();
    playback.step(100, "", kNow);
    return playback;
  };
  Playback paused = stepping();
  paused.pause(kNow);
  EXPECT_EQ(paused.stepsLeft(), 0U);
  EXPECT_TRUE(paused.due(at(10)).is_held);
  Playback resumed = stepping();
  resumed.resume(kNow);
  EXPECT_EQ(resumed.stepsLeft(), 0U);
  EXPECT_EQ(resumed.due(at(10)).deadline_ns, kNow + 10 * kMs);
  Playback sought = stepping();
  sought.seek(at(500), kNow);
  EXPECT_TRUE(sought.due(at(500)).is_held);
}

TEST(Playback, ASeekGoesBothWaysAndPlaysOnFromThere) {
  Playback playback = begun();
  (void)playback.due(at(10));
  playback.seek(at(300), kNow + 3 * kMs);
  EXPECT_EQ(playback.position(kNow + 3 * kMs), at(300));
  EXPECT_EQ(playback.due(at(307)).deadline_ns, kNow + 10 * kMs) << "the gap before the next message is kept";
  playback.sent("a", at(307), kNow + 10 * kMs);
  playback.seek(at(2), kNow + 20 * kMs);
  EXPECT_EQ(playback.due(at(2)).deadline_ns, kNow + 20 * kMs);
}

TEST(Playback, ASeekInAPauseStaysPaused) {
  Playback playback = begun();
  playback.pause(kNow);
  playback.seek(at(300), kNow);
  EXPECT_TRUE(playback.due(at(301)).is_held);
  EXPECT_EQ(playback.position(kNow + 1000 * kMs), at(300));
  playback.resume(kNow + 1000 * kMs);
  EXPECT_EQ(playback.due(at(301)).deadline_ns, kNow + 1001 * kMs);
}

TEST(Playback, AChangeOfRateCountsFromWhereItStands) {
  Playback playback = begun();
  (void)playback.due(at(10));
  playback.setRate(0.5, kNow + 4 * kMs);
  EXPECT_EQ(playback.due(at(10)).deadline_ns, kNow + 16 * kMs) << "6 ms are left, which take 12";
  playback.setRate(0.0, kNow + 6 * kMs);
  EXPECT_FALSE(playback.due(at(10)).deadline_ns);
  playback.sent("a", at(10), kNow + 6 * kMs);
  playback.setRate(1.0, kNow + 7 * kMs);
  EXPECT_EQ(playback.due(at(30)).deadline_ns, kNow + 27 * kMs) << "from the last message, which nobody timed";
}

TEST(Playback, AChangeOfRateInAPauseHolds) {
  Playback playback = begun();
  playback.pause(kNow);
  playback.setRate(4.0, kNow + 100 * kMs);
  EXPECT_TRUE(playback.due(at(10)).is_held);
  playback.resume(kNow + 1000 * kMs);
  EXPECT_EQ(playback.due(at(8)).deadline_ns, kNow + 1002 * kMs);
}

TEST(Playback, ALongStallIsNotCaughtUpAndAShortDelayIs) {
  Playback playback = begun();
  playback.sent("a", at(10), kNow + 510 * kMs);
  EXPECT_EQ(playback.due(at(20)).deadline_ns, kNow + 20 * kMs);
  playback.sent("a", at(20), kNow + 5020 * kMs);
  EXPECT_EQ(playback.due(at(30)).deadline_ns, kNow + 5030 * kMs);
}

TEST(Playback, EndsAfterItsPasses) {
  Playback playback = begun({.passes = 3});
  EXPECT_EQ(playback.reachEnd(), Playback::AtEnd::kAgain);
  playback.begin(at(0), kNow + 100 * kMs);
  EXPECT_EQ(playback.pass(), 2U);
  EXPECT_EQ(playback.due(at(0)).deadline_ns, kNow + 100 * kMs);
  EXPECT_EQ(playback.reachEnd(), Playback::AtEnd::kAgain);
  EXPECT_EQ(playback.reachEnd(), Playback::AtEnd::kOver);
}

TEST(Playback, GoesRoundForEverWhenAskedTo) {
  Playback playback = begun({.passes = 0});
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(playback.reachEnd(), Playback::AtEnd::kAgain);
}

TEST(Playback, HeldAtItsEndItStaysUntilItIsLetGo) {
  Playback playback = begun();
  playback.step(5, "", kNow);
  EXPECT_EQ(playback.reachEnd(), Playback::AtEnd::kHold);
  EXPECT_EQ(playback.stepsLeft(), 5U) << "that did not come";
  playback.pause(kNow);
  EXPECT_EQ(playback.reachEnd(), Playback::AtEnd::kHold);
  playback.seek(at(0), kNow);
  EXPECT_TRUE(playback.due(at(0)).is_held);
  playback.resume(kNow);
  EXPECT_EQ(playback.reachEnd(), Playback::AtEnd::kOver);
}

TEST(Playback, CountsTheLogTimeThatWasPlayedAndNoneThatWasSkipped) {
  Playback playback = begun();
  playback.sent("a", at(10), kNow);
  playback.seek(at(500), kNow);
  playback.sent("a", at(505), kNow);
  playback.sent("a", at(507), kNow);
  playback.begin(at(0), kNow);
  playback.sent("a", at(0), kNow);
  playback.sent("a", at(1), kNow);
  EXPECT_EQ(playback.playedTime(), static_cast<std::uint64_t>(13 * kMs));
}

}  // namespace
}  // namespace baton
