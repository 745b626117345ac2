// Clocks that were set during a recording, seen in the log times alone.
#include "bag/log_times.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

constexpr std::uint64_t kStart = 1'700'000'000'000'000'000;
constexpr std::uint64_t kMs = 1'000'000;
constexpr std::uint64_t kHour = 3'600'000 * kMs;
constexpr mcap::ChannelId kOne{1}, kTwo{2};

/// So many messages, a millisecond apart.
void add(LogTimes& times, mcap::ChannelId channel, std::uint64_t begin, std::uint64_t count,
         std::uint64_t apart = kMs) {
  for (std::uint64_t i = 0; i < count; ++i) times.add(channel, begin + i * apart);
}

/// The only finding.
std::string finding(const LogTimes& times) {
  const auto found = times.findings();
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? "" : found.front();
}

bool mentions(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(LogTimes, AClockThatRanOnIsNotNamed) {
  LogTimes times;
  EXPECT_TRUE(times.findings().empty());
  add(times, kOne, kStart, 5000);
  add(times, kTwo, kStart + 100, 5000);  // a file may have one topic after the other
  EXPECT_TRUE(times.findings().empty());
}

TEST(LogTimes, AClockSetForwardsLeavesAHole) {
  for (const std::uint64_t count : {5U, 1000U}) {
    LogTimes times;
    add(times, kOne, kStart, count);
    add(times, kOne, kStart + kHour, count);
    EXPECT_TRUE(mentions(finding(times), "nothing was logged for 3599.")) << finding(times);
    EXPECT_TRUE(mentions(finding(times), "--skip-gaps"));
  }
}

TEST(LogTimes, AHoleIsFoundInWhateverOrderTheFileHasItsMessages) {
  LogTimes times;
  add(times, kOne, kStart + kHour, 100);
  add(times, kTwo, kStart, 100);
  add(times, kTwo, kStart + 2 * kHour, 100);
  EXPECT_TRUE(mentions(finding(times), "(and 1 shorter ones)")) << finding(times);
  LogTimes filled;  // by a third topic, later in the file
  add(filled, kOne, kStart, 2);
  add(filled, kOne, kStart + 5'000 * kMs, 2);
  add(filled, kTwo, kStart, 5'000);
  EXPECT_TRUE(filled.findings().empty());
}

TEST(LogTimes, ASlowRhythmIsNoHole) {
  LogTimes few, many;
  add(few, kOne, kStart, 20, 10'000 * kMs);
  add(many, kOne, kStart, 5000, 10'000 * kMs);
  EXPECT_TRUE(few.findings().empty());
  EXPECT_TRUE(many.findings().empty());
}

TEST(LogTimes, AClockSetBackIsNamed) {
  LogTimes times;
  add(times, kOne, kStart, 1000);
  add(times, kOne, kStart + 1000 * kMs - 10'000 * kMs, 12'000);
  EXPECT_TRUE(mentions(finding(times), "go back by 9.999 s")) << finding(times);
  LogTimes swapped;  // two threads of one recorder
  for (const std::uint64_t ms : {1, 3, 2, 4}) swapped.add(kOne, kStart + ms * kMs);
  EXPECT_TRUE(swapped.findings().empty());
}

TEST(LogTimes, MessagesWithOneTimeAreNamed) {
  LogTimes times;
  add(times, kOne, kStart, 1000);
  add(times, kOne, kStart + 999 * kMs, 2668, 0);
  add(times, kOne, kStart + 1000 * kMs, 100);
  EXPECT_TRUE(mentions(finding(times), "2669 messages")) << finding(times);
}

TEST(LogTimes, ThePartsOfARecordingAreOne) {
  LogTimes times;
  add(times, kOne, kStart, 100);
  times.nextFile();
  add(times, kOne, kStart + kHour, 100);
  EXPECT_TRUE(mentions(finding(times), "nothing was logged"));
  LogTimes other;  // the same number, another channel
  add(other, kOne, kStart + 5'000 * kMs, 10);
  other.nextFile();
  add(other, kOne, kStart + 4'500 * kMs, 10);
  EXPECT_TRUE(other.findings().empty());
}

}  // namespace
}  // namespace baton
