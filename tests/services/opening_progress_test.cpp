/// What is shown while a recording is being opened.
#include "opening_progress.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

using std::chrono::milliseconds;

TEST(OpeningText, IsThereWhenAFileTakesLong) {
  OpeningText text;
  const OpeningText::Clock::time_point begin{};
  EXPECT_EQ(text.at(begin, "run.mcap", 0, 1000), "");
  EXPECT_EQ(text.at(begin + milliseconds(1999), "run.mcap", 400, 1000), "");
  EXPECT_EQ(text.at(begin + milliseconds(2000), "run.mcap", 425, 1000), "reading run.mcap 42 %");
  EXPECT_EQ(text.at(begin + milliseconds(2100), "run.mcap", 1000, 1000), "") << "it is open";
  EXPECT_EQ(text.at(begin + milliseconds(2200), "run.mcap", 10, 1000), "") << "and is opened again";
}

TEST(OpeningText, CountsFromTheBeginningOfEachFile) {
  OpeningText text;
  const OpeningText::Clock::time_point begin{};
  EXPECT_EQ(text.at(begin, "a.mcap", 0, 10), "");
  EXPECT_EQ(text.at(begin + milliseconds(3000), "b.mcap", 0, 10), "");
  EXPECT_EQ(text.at(begin + milliseconds(5000), "b.mcap", 5, 10), "reading b.mcap 50 %");
  EXPECT_EQ(text.at(begin + milliseconds(6000), "empty.mcap", 0, 0), "");
}

}  // namespace
}  // namespace baton
