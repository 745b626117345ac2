// What a scenario says of its recording: which topics, how it lies on the disk, and what does not go together.
#include <gtest/gtest.h>

#include "bad_input.hpp"
#include "runtime/scenario.hpp"

namespace baton {
namespace {

using test::BadInput;
using test::refusal;
using test::rppScenario;

std::string textWith(const std::string& recording) {
  return R"(name: recorded
robot: rpp.yaml
step_s: 0.001
trajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}
controllers: [{name: a, law: joint_pd}]
active: a
recording:
)" + recording;
}

RecordingConfig parse(const std::string& recording) {
  return rppScenario("recorded.yaml", textWith(recording)).recording;
}

TEST(ScenarioRecording, WithoutAWordAllIsRecordedInOneFile) {
  const RecordingConfig config = parse("  enabled: true\n");
  EXPECT_TRUE(config.topics.empty() && config.except.empty() && config.takes_foreign);
  EXPECT_EQ(config.split_bytes + config.split_steps + config.ring_steps + config.max_bytes, 0u);
  EXPECT_EQ(config.min_free_bytes, 10'000'000u) << "for the run's other files";
  EXPECT_FALSE(config.starts_stopped);
  EXPECT_EQ(config.level, 0);
}

TEST(ScenarioRecording, GivesEachFieldItsPlace) {
  const RecordingConfig config = parse(
      "  topics: [plant_*, contact]\n  except: ['*_again']\n  compression: zstd\n  level: 9\n  chunk_kB: 64\n"
      "  split_MB: 2.5\n  split_s: 10\n  max_MB: 100\n  when_full: drop_oldest\n  min_free_MB: 500\n"
      "  start: on_request\n  foreign: false\n");
  EXPECT_FALSE(config.takes_foreign);
  EXPECT_EQ(config.topics, (std::vector<std::string>{"plant_*", "contact"}));
  EXPECT_EQ(config.except, std::vector<std::string>{"*_again"});
  EXPECT_EQ(config.level, 9);
  EXPECT_EQ(config.chunk_bytes, 64'000u);
  EXPECT_EQ(config.split_bytes, 2'500'000u);
  EXPECT_EQ(config.split_steps, 10'000u);
  EXPECT_EQ(config.max_bytes, 100'000'000u);
  EXPECT_TRUE(config.drops_oldest);
  EXPECT_EQ(config.min_free_bytes, 500'000'000u);
  EXPECT_TRUE(config.starts_stopped);
}

TEST(ScenarioRecording, ARingHasItsSecondsAndItsMemory) {
  const RecordingConfig config = parse("  ring_s: 2\n  ring_MB: 10\n");
  EXPECT_EQ(config.ring_steps, 2000u);
  EXPECT_EQ(config.ring_bytes, 10'000'000u);
}

class BadRecording : public testing::TestWithParam<BadInput> {};

TEST_P(BadRecording, IsRefused) {
  const std::string text = textWith(GetParam().to);
  test::expectMessage(refusal([&] { return rppScenario("recorded.yaml", text); }), "recorded.yaml", text, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadRecording,
    testing::Values(BadInput{"LevelOutOfRange", "", "  level: 23\n", "level", "from -100 to 22", "23"},
                    BadInput{"LevelOfLz4", "", "  compression: lz4\n  level: 13\n", "level", "from -100 to 12", "13"},
                    BadInput{"LevelOfNothing", "", "  compression: none\n  level: 3\n", "level", "no level", ""},
                    BadInput{"NoPattern", "", "  topics: []\n", "topics", "", ""},
                    BadInput{"EmptyPattern", "", "  except: ['']\n", "except", "a pattern", ""},
                    BadInput{"HalfAStep", "", "  split_s: 0.0005\n", "split_s", "", ""},
                    BadInput{"NoStep", "", "  ring_s: 0\n", "ring_s", "at least one step", ""},
                    BadInput{"RingAndParts", "", "  ring_s: 1\n  split_MB: 10\n", "split_MB", "beside ring_s", ""},
                    BadInput{"RingAndBudget", "", "  ring_s: 1\n  max_MB: 10\n", "max_MB", "beside ring_s", ""},
                    BadInput{"RingOnRequest", "", "  ring_s: 1\n  start: on_request\n", "start", "beside ring_s", ""},
                    BadInput{"RingMemoryAlone", "", "  ring_MB: 10\n", "ring_MB", "ring_s beside it", ""},
                    BadInput{"FullOfWhat", "", "  when_full: stop\n", "when_full", "max_MB or min_free_MB", ""},
                    BadInput{"NothingToDrop", "", "  max_MB: 10\n  when_full: drop_oldest\n", "when_full",
                             "split_MB or split_s", ""},
                    BadInput{"BudgetOfLessThanFourChunks", "", "  max_MB: 0.5\n", "max_MB", "four chunks", ""},
                    BadInput{"PartsOfLessThanAChunk", "", "  split_MB: 0.1\n", "split_MB", "a chunk", ""},
                    BadInput{"NoRoomForTwoParts", "", "  max_MB: 10\n  split_MB: 6\n  when_full: drop_oldest\n",
                             "max_MB", "room for two parts", ""},
                    BadInput{"UnknownWord", "", "  start: soon\n", "start", "on_request", "soon"}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace baton
