/// The replayer's command line.
#include "options.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "summary.hpp"

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
  EXPECT_EQ(options.interfaces, std::vector<std::string>{"127.0.0.1"}) << "whatever the loopback is called";
  EXPECT_TRUE(options.topics.empty());
  EXPECT_FALSE(!options.range.isAll());
}

TEST(ReplayOptions, SpeakInARunOfTheirOwnUnlessTold) {
  EXPECT_FALSE(parsed({"run.mcap"}).run.empty());
  EXPECT_EQ(parsed({"run.mcap", "--run", "a"}).run, "a");
}

TEST(ReplayOptions, RateIsAFactorOrMax) {
  EXPECT_EQ(parsed({"run.mcap", "--rate", "0.5"}).rate, 0.5);
  EXPECT_EQ(parsed({"run.mcap", "--rate", "max"}).rate, 0.0);
  for (const char* wrong : {"0", "-1", "nan", "inf", "1e300", "2x", "fast", ""}) {
    EXPECT_THROW((void)parsed({"run.mcap", "--rate", wrong}), UsageError) << wrong;
  }
}

TEST(ReplayOptions, GapsAreKeptUnlessTheyAreToBeSkipped) {
  EXPECT_FALSE(parsed({"run.mcap"}).longest_gap_s);
  EXPECT_EQ(parsed({"run.mcap", "--skip-gaps", "0.5"}).longest_gap_s, 0.5);
  for (const char* wrong : {"-1", "nan", "inf", "x"}) {
    EXPECT_THROW((void)parsed({"run.mcap", "--skip-gaps", wrong}), UsageError) << wrong;
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

TEST(ReplayOptions, ALoopHasAnEndOrNone) {
  EXPECT_EQ(parsed({"run.mcap"}).passes, 1U);
  EXPECT_EQ(parsed({"run.mcap", "--loop"}).passes, 0U);
  EXPECT_EQ(parsed({"run.mcap", "--loop", "--paused"}).passes, 0U);
  EXPECT_EQ(parsed({"run.mcap", "--loop", "3"}).passes, 3U);
  EXPECT_EQ(parsed({"--loop=3", "run.mcap"}).passes, 3U);
  for (const char* wrong : {"0", "-1", "x", "1.5"}) {
    EXPECT_THROW((void)parsed({"run.mcap", "--loop", wrong}), UsageError) << wrong;
  }
}

TEST(ReplayOptions, ReadersAreAListThatLeavesTheFileAlone) {
  const ReplayOptions options = parsed({"--wait-for-readers", "recorder,environment", "run.mcap", "--wait-for", "2"});
  EXPECT_EQ(options.wait_for_readers, (std::vector<std::string>{"recorder", "environment"}));
  EXPECT_EQ(options.file, "run.mcap");
  EXPECT_EQ(options.wait_for, 2U);
  EXPECT_THROW((void)parsed({"run.mcap", "--wait-for", "99999999999"}), UsageError) << "it would wait for ever";
}

TEST(ReplayOptions, APartitionMayBeTheOneWithoutAName) {
  EXPECT_FALSE(parsed({"run.mcap"}).partition);
  EXPECT_EQ(parsed({"run.mcap", "--partition", ""}).partition, "");
  EXPECT_EQ(parsed({"run.mcap", "--partition", "lab"}).partition, "lab");
}

TEST(ReplayOptions, ALimitOfLatenessNeedsARate) {
  EXPECT_EQ(parsed({"run.mcap", "--max-late-us", "500"}).max_late_us, 500.0);
  EXPECT_THROW((void)parsed({"run.mcap", "--max-late-us", "500", "--rate", "max"}), UsageError);
  EXPECT_THROW((void)parsed({"run.mcap", "--max-late-us", "-1"}), UsageError);
}

TEST(ReplayOptions, RefuseATimeRangeThatEndsBeforeItStarts) {
  EXPECT_EQ(parsed({"run.mcap", "--from", "1", "--to", "2"}).range.to_s, 2.0);
  EXPECT_THROW((void)parsed({"run.mcap", "--from", "2", "--to", "1"}), UsageError);
  EXPECT_THROW((void)parsed({"run.mcap", "--from", "-1"}), UsageError);
}

TEST(ReplaySummary, TellsOfHowManyMessagesOfAPassAndOfHowManyPasses) {
  ReplayResult result;
  result.messages = 1;
  result.total = 1;
  result.passes = 1;
  result.writers = 1;
  result.topics = 2;
  EXPECT_EQ(summaryText(result, {}).find("replayed     1 of 1 message, 1 writer, 2 topics\n"), 0U);
  result.was_interrupted = true;
  result.messages = 5282;
  result.total = 4493;
  result.passes = 2;
  EXPECT_EQ(summaryText(result, {}).find("interrupted  5282 in 2 passes of 4493 messages, 1 writer, 2 topics\n"), 0U);
}

}  // namespace
}  // namespace baton
