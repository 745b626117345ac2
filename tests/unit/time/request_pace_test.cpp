#include "time/request_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace baton {
namespace {

constexpr RequestPace::Asker kOne{1}, kOther{2};
constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(RequestPace, AFewAreTakenAtOnceAndTheRestOneAfterTheOther) {
  RequestPace pace;
  constexpr std::int64_t kNow = 5 * kSecond_ns;
  for (int i = 0; i < RequestPace::kAtOnce; ++i) EXPECT_EQ(pace.admit(kOne, kNow), kNow) << i;
  for (int i = 1; i <= 50; ++i) EXPECT_EQ(pace.admit(kOne, kNow), kNow + i * RequestPace::kInterval_ns);
  EXPECT_EQ(pace.admit(kOther, kNow), kNow) << "a flood delays no other asker";
}

TEST(RequestPace, WhoAsksSlowlyNeverWaits) {
  RequestPace pace;
  for (std::int64_t now = 0; now < 10 * kSecond_ns; now += RequestPace::kInterval_ns) {
    ASSERT_EQ(pace.admit(kOne, now), now);
  }
}

TEST(RequestPace, AFloodIsTakenAtThePaceAndInOrderAndTheRestIsLeftOut) {
  RequestPace pace;
  constexpr std::int64_t kFlood_ns = 2 * kSecond_ns, kEvery_ns = 200'000;  // 5000 a second
  std::int64_t taken = 0, left_out = 0, last_due = 0;
  for (std::int64_t now = 0; now < kFlood_ns; now += kEvery_ns) {
    const auto due = pace.admit(kOne, now);
    if (!due) {
      ++left_out;
      continue;
    }
    ++taken;
    EXPECT_GE(*due, std::max(now, last_due));
    EXPECT_LE(*due - now, RequestPace::kLongestWait_ns);
    last_due = *due;
  }
  EXPECT_EQ(taken + left_out, kFlood_ns / kEvery_ns);
  const std::int64_t most =
      RequestPace::kAtOnce + (kFlood_ns + RequestPace::kLongestWait_ns) / RequestPace::kInterval_ns;
  EXPECT_LE(taken, most);
  EXPECT_GE(taken, most - 2) << "and no fewer";
  EXPECT_EQ(pace.admit(kOne, last_due + kSecond_ns), last_due + kSecond_ns) << "it is forgiven";
}

TEST(RequestPace, ManyAskersDoNotFillTheMemoryForEver) {
  RequestPace pace;
  RequestPace::Asker asker{};
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    for (std::size_t byte = 0; byte < 4; ++byte) asker.at(byte) = static_cast<std::uint8_t>(i >> (8 * byte));
    const std::int64_t now = std::int64_t{i} * RequestPace::kInterval_ns;
    ASSERT_EQ(pace.admit(asker, now), now);
  }
  EXPECT_LE(pace.size(), 1000U);
}

}  // namespace
}  // namespace baton
