/// The replayer's command line.
#include "options.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace baton {
namespace {

ReplayOptions parsed(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "baton-replayer");
  ReplayOptions options;
  EXPECT_TRUE(parseReplayOptions(static_cast<int>(arguments.size()), arguments.data(), options));
  return options;
}

TEST(ReplayOptions, NeedAFileAlone) {
  const ReplayOptions options = parsed({"run.mcap"});
  EXPECT_EQ(options.file, "run.mcap");
  EXPECT_EQ(options.cell, "replay");
  EXPECT_EQ(options.rate, 1.0);
  EXPECT_TRUE(options.topics.empty());
  EXPECT_FALSE(options.from_s || options.to_s);
}

TEST(ReplayOptions, SpeakInARunOfTheirOwnUnlessTold) {
  EXPECT_FALSE(parsed({"run.mcap"}).run.empty());
  EXPECT_EQ(parsed({"run.mcap", "--run", "a"}).run, "a");
}

TEST(ReplayOptions, RateIsAFactorOrMax) {
  EXPECT_EQ(parsed({"run.mcap", "--rate", "0.5"}).rate, 0.5);
  EXPECT_EQ(parsed({"run.mcap", "--rate", "max"}).rate, 0.0);
  for (const char* wrong : {"0", "-1", "nan", "inf", "2x", "fast", ""}) {
    EXPECT_THROW((void)parsed({"run.mcap", "--rate", wrong}), UsageError) << wrong;
  }
}

TEST(ReplayOptions, TopicsLeaveTheFileAlone) {
  const ReplayOptions options = parsed({"--topics", "a,b", "run.mcap"});
  EXPECT_EQ(options.topics, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(options.file, "run.mcap");
}

TEST(ReplayOptions, RemapTakesPairs) {
  const ReplayOptions options = parsed({"run.mcap", "--remap", "a=b", "c=d"});
  EXPECT_EQ(options.remap, (std::map<std::string, std::string>{{"a", "b"}, {"c", "d"}}));
  for (const char* wrong : {"a", "a=", "=b", "="}) {
    EXPECT_THROW((void)parsed({"run.mcap", "--remap", wrong}), UsageError) << wrong;
  }
  EXPECT_THROW((void)parsed({"run.mcap", "--remap", "a=b", "a=c"}), UsageError);
}

TEST(ReplayOptions, RefuseATimeRangeThatEndsBeforeItStarts) {
  EXPECT_EQ(parsed({"run.mcap", "--from", "1", "--to", "2"}).to_s, 2.0);
  EXPECT_THROW((void)parsed({"run.mcap", "--from", "2", "--to", "1"}), UsageError);
  EXPECT_THROW((void)parsed({"run.mcap", "--from", "-1"}), UsageError);
}

}  // namespace
}  // namespace baton
