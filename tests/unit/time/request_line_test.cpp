/// Whose turn it is, whichever timer runs out first.
#include "time/request_line.hpp"

#include <gtest/gtest.h>

#include <string>

namespace baton {
namespace {

constexpr RequestPace::Asker kOne{1}, kOther{2};

TEST(RequestLine, EachAskersRequestsAreTakenInTheOrderInWhichTheyCame) {
  std::string taken;
  const auto action = [&taken](char name) { return [&taken, name] { taken += name; }; };
  RequestLine line;
  line.add(kOne, action('a'));
  line.add(kOther, action('x'));
  line.add(kOne, action('b'));
  line.next(kOne)();  // whichever of the two its timer was of
  line.next(kOther)();
  line.next(kOne)();
  EXPECT_EQ(taken, "axb");
}

TEST(RequestLine, NoneIsTakenAtOnceWhileAnEarlierOneOfItsAskerWaits) {
  RequestPace pace;
  RequestLine line;
  constexpr std::int64_t kNow = 5'000'000'000;
  for (std::int64_t i = 0; i < RequestPace::kAtOnce; ++i) ASSERT_EQ(pace.admit(kOne, kNow), kNow);
  ASSERT_GT(pace.admit(kOne, kNow), kNow) << "this one waits";
  line.add(kOne, [] {});
  // Its timer has not run out when another one comes, much later.
  constexpr std::int64_t kLater = kNow + 1'000'000'000;
  EXPECT_EQ(pace.admit(kOne, kLater), kLater) << "its own time is now";
  EXPECT_TRUE(line.isWaiting(kOne)) << "and it must not overtake";
  EXPECT_FALSE(line.isWaiting(kOther));
  line.next(kOne)();
  EXPECT_FALSE(line.isWaiting(kOne));
}

}  // namespace
}  // namespace baton
