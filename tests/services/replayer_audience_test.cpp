/// Who has to listen before a replay begins.
#include "audience.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;

dds::GuidPrefix process(std::uint8_t number) { return {number}; }

TEST(Audience, NobodyIsWaitedForUnlessAsked) { EXPECT_EQ(Audience(0, {}).missing({{"state", {}}}, kNow), ""); }

TEST(Audience, ACountIsOfEveryWriter) {
  Audience audience(1, {});
  Readers readers{{"state", {}}, {"state", {{process(1), ""}}}, {"contact", {{process(1), ""}}}};
  EXPECT_EQ(audience.missing(readers, kNow), "1 reading processes on state");
  readers.begin()->second.clear();
  for (auto& [topic, processes] : readers) processes.emplace(process(2), "somebody");
  EXPECT_EQ(audience.missing(readers, kNow), "");
}

TEST(Audience, ANameIsThatOfAServiceWhichReadsSomething) {
  Audience audience(0, {"recorder", "environment"});
  Readers readers{{"state", {{process(1), "recorder"}}}, {"contact", {{process(2), ""}}}};
  EXPECT_EQ(audience.missing(readers, kNow), "environment to read a topic");
  readers.find("contact")->second.emplace(process(3), "environment");
  EXPECT_NE(audience.missing(readers, kNow), "") << "more of their readers may be on their way";
  EXPECT_NE(audience.missing(readers, kNow + Audience::kSettled_ns - 1), "");
  EXPECT_EQ(audience.missing(readers, kNow + Audience::kSettled_ns), "");
}

TEST(Audience, AReaderThatComesLateIsWaitedForAgain) {
  Audience audience(0, {"recorder"});
  Readers readers{{"state", {{process(1), "recorder"}}}, {"contact", {}}};
  (void)audience.missing(readers, kNow);
  readers.find("contact")->second.emplace(process(1), "recorder");
  EXPECT_NE(audience.missing(readers, kNow + Audience::kSettled_ns), "");
  EXPECT_EQ(audience.missing(readers, kNow + 2 * Audience::kSettled_ns), "");
}

}  // namespace
}  // namespace baton
