/// Recording without a run: what its command line means, which writers it concerns, what its exit code says.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "traffic/options.hpp"
#include "traffic/result.hpp"

namespace baton {
namespace {

using Strings = std::vector<std::string>;

TrafficOptions parsed(Strings arguments) {
  arguments.insert(arguments.begin(), {"baton record traffic", "out.mcap"});
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  TrafficOptions options;
  EXPECT_TRUE(parseTrafficOptions(static_cast<int>(argv.size()), argv.data(), options));
  return options;
}

TEST(TrafficOptions, WithoutAnyEverythingIsRecordedUntilASignal) {
  const TrafficOptions options = parsed({});
  EXPECT_EQ(options.out, "out.mcap");
  EXPECT_TRUE(options.interfaces.empty());
  EXPECT_TRUE(options.selection.isRecorded("anything"));
  EXPECT_FALSE(options.duration_s.has_value());
  EXPECT_EQ(options.max_messages, 0U);
  EXPECT_FALSE(options.recording.isSplit());
  EXPECT_EQ(options.recording.max_bytes, 0U);
  EXPECT_EQ(options.recording.min_free_bytes, RecordingConfig{}.min_free_bytes) << "as a run's recorder does";
}

TEST(TrafficOptions, PatternsComeWithCommasOrOneByOne) {
  const TrafficOptions options = parsed({"--topics", "a,b*", "--topics", "rt/?", "--except", "b_*"});
  EXPECT_EQ(options.selection.topics, (Strings{"a", "b*", "rt/?"}));
  EXPECT_TRUE(options.selection.isRecorded("rt/x"));
  EXPECT_TRUE(options.selection.isRecorded("bc"));
  EXPECT_FALSE(options.selection.isRecorded("b_c"));
  EXPECT_FALSE(options.selection.isRecorded("c"));
}

TEST(TrafficOptions, LimitsAreInTheirUnits) {
  const TrafficOptions options =
      parsed({"--duration", "1.5", "--max-MB", "2", "--split-MB", "0.5", "--split-s", "60", "--min-free-MB", "0"});
  EXPECT_EQ(options.duration_s, 1.5);
  EXPECT_EQ(options.recording.max_bytes, 2'000'000U);
  EXPECT_EQ(options.recording.split_bytes, 500'000U);
  EXPECT_EQ(options.recording.split_steps, 60'000U) << "ms";
  EXPECT_EQ(options.recording.min_free_bytes, 0U);
  EXPECT_LE(parsed({"--max-MB", "0.1"}).recording.chunk_bytes, 25'000U) << "several chunks have to fit";
}

TEST(TrafficOptions, WhatIsNoLimitIsRefused) {
  for (const Strings& wrong : {Strings{"--duration", "0"},
                               {"--duration", "-1"},
                               {"--duration", "nan"},
                               {"--max-MB", "0"},
                               {"--max-MB", "1e30"},
                               {"--split-MB", "-1"},
                               {"--split-s", "0"},
                               {"--min-free-MB", "-1"},
                               {"--max-messages", "0"},
                               {"--domain", "233"},
                               {"--compression", "gzip"},
                               {"--topcis", "a"}}) {
    EXPECT_THROW((void)parsed(wrong), UsageError) << wrong.front() << " " << wrong.back();
  }
}

TEST(TrafficOptions, ALimitOutOfRangeIsShownAsItWasMeant) {
  const auto refusal = [](const Strings& wrong) {
    try {
      (void)parsed(wrong);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal({"--duration", "1e300"}), "--duration: expected 0.001 to 1e9 s, found 1e+300");
  EXPECT_EQ(refusal({"--max-MB", "1e-300"}), "--max-MB: expected 0.001 to 1e9 MB, found 1e-300");
}

TEST(Partitions, AllOfThemAreReadAndThoseWhoSetNone) {
  const Strings all = readPartitions({});
  EXPECT_EQ(all, (Strings{"*", ""})) << "in DDS * alone does not match a writer without";
  for (const Strings& writer : {Strings{}, {""}, {"lab/run"}, {"a", "b"}, {"lab*"}}) {
    EXPECT_TRUE(isInPartitions(writer, all));
  }
}

TEST(Partitions, APatternTakesThoseItMatches) {
  EXPECT_EQ(readPartitions({"lab/*"}), (Strings{"lab/*"}));
  EXPECT_TRUE(isInPartitions({"lab/run"}, {"lab/*"}));
  EXPECT_TRUE(isInPartitions({"l*"}, {"lab"})) << "the writer's may be a pattern as well";
  EXPECT_TRUE(isInPartitions({"other", "lab/run"}, {"lab/*"}));
  EXPECT_FALSE(isInPartitions({"other"}, {"lab/*"}));
  EXPECT_FALSE(isInPartitions({}, {"lab/*"}));
  EXPECT_EQ(readPartitions({""}), (Strings{""}));
  EXPECT_FALSE(isInPartitions({"lab"}, {""}));
  EXPECT_EQ(readPartitions({"*"}), (Strings{"*", ""}));
}

TEST(TrafficExitCode, ASignalIsTheOrdinaryEndUnlessAnotherOneWasAskedFor) {
  TrafficResult result;
  result.is_complete = true;
  TrafficOptions endless, bounded, counted;
  bounded.duration_s = 5.0;
  counted.max_messages = 5;
  EXPECT_EQ(exitCodeOf(result, endless), ExitCode::kOk);
  EXPECT_EQ(exitCodeOf(result, bounded), ExitCode::kInterrupted);
  EXPECT_EQ(exitCodeOf(result, counted), ExitCode::kInterrupted);
  result.end = TrafficEnd::kReached;
  EXPECT_EQ(exitCodeOf(result, bounded), ExitCode::kOk);
  EXPECT_EQ(exitCodeOf(result, endless), ExitCode::kOk) << "--max-MB is a wish as well";
  result.is_complete = false;
  EXPECT_EQ(exitCodeOf(result, bounded), ExitCode::kFailed);
  result.end = TrafficEnd::kSignal;
  EXPECT_EQ(exitCodeOf(result, endless), ExitCode::kFailed);
}

TEST(TrafficResult, NamesWhatIsLostAndIsSafeToPrint) {
  TrafficResult result;
  result.files = {"out.mcap"};
  result.summary = "incomplete: b: 3 samples are missing";
  result.problems = {"b of \x1b[2J: 3 samples are missing"};
  result.topics = {{"a", "T", 10, 0, 1}, {"b\n", "U", 5, 3, 2}};
  result.losses = {{"b\n", "0102", "", 3}};
  const std::string text = textOf(result, {});
  EXPECT_NE(text.find("0 of 2 topics, 3 lost"), std::string::npos) << text;
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_NE(text.find("problem     b of \\x1b[2J: 3 samples are missing"), std::string::npos) << text;
  const nlohmann::json json = nlohmann::json::parse(jsonOf(result, {}));
  EXPECT_EQ(json.at("lost"), 3);
  EXPECT_EQ(json.at("exit_code"), 1);
  EXPECT_EQ(json.at("losses").at(0).at("lost"), 3);
  EXPECT_EQ(json.at("topics").at(1).at("writers"), 2);
}

}  // namespace
}  // namespace baton
