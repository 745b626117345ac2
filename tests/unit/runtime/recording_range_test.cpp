/// Ranges of log time, of steps and of simulated time, and what of a recording they take.
#include "runtime/recording_range.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/writer.hpp"
#include "msg/idl_text.hpp"

namespace baton {
namespace {

mcap::ByteView bytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

/// A recording of a few steps of 2 ms: state k is logged at k ms, the command for it 0.1 ms later.
class RecordingRangeTest : public testing::Test {
 protected:
  RecordingRangeTest() {
    std::string name = (std::filesystem::temp_directory_path() / "baton-range-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = name;
    file = (folder_ / "run.mcap").string();
    writer.emplace(file);
  }
  ~RecordingRangeTest() override { std::filesystem::remove_all(folder_); }

  template <class T>
  void write(const dds::Topic<T>& topic, const T& message, double at_ms) {
    mcap::ChannelId& channel = channels_[topic.name];
    if (channel == mcap::ChannelId{}) {
      mcap::SchemaId schema{};
      for (const msg::IdlText& idl : msg::allIdlTexts()) {
        if (idl.type_name == std::string(topic.type))
          schema = writer->addSchema(topic.type, "omgidl", bytesOf(idl.text));
      }
      channel = writer->addChannel(topic.name, "cdr", schema);
    }
    std::vector<std::byte> buffer(dds::maxPayload<T>());
    write(channel, dds::encode(message, buffer), at_ms);
  }
  void write(mcap::ChannelId channel, mcap::ByteView payload, double at_ms) {
    const auto time_ns = static_cast<std::uint64_t>(std::llround(at_ms * 1e6)) + 1'000'000'000;
    writer->write(channel, ++sequence_, time_ns, time_ns, payload);
  }
  /// Of another vendor, which carries a step.
  void writeProbe(std::uint64_t step, double at_ms) {
    if (probe_ == mcap::ChannelId{}) {
      const auto schema = writer->addSchema("Probe", "omgidl", bytesOf("struct Probe { unsigned long long step; };"));
      probe_ = writer->addChannel("probe", "cdr", schema);
    }
    std::vector<std::byte> payload{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    for (int i = 0; i < 8; ++i) payload.push_back(static_cast<std::byte>(step >> (8 * i)));
    write(probe_, payload, at_ms);
  }
  void writeNote(double at_ms) {
    if (note_ == mcap::ChannelId{}) note_ = writer->addChannel("note", "cdr", mcap::kNoSchema);
    write(note_, bytesOf("bytes"), at_ms);
  }
  void writeState(std::uint64_t step, double at_ms) {
    msg::PlantState state;
    state.step(step);
    state.time_ns(static_cast<std::int64_t>(step) * 2'000'000);
    write(dds::topics::kPlantState, state, at_ms);
  }
  void writeSteps(std::uint64_t first, std::uint64_t last, double from_ms) {
    for (std::uint64_t step = first; step <= last; ++step) {
      const double at_ms = from_ms + static_cast<double>(step - first);
      writeState(step, at_ms);
      msg::JointCommand command;
      command.step(step);
      write(dds::topics::kJointCommand, command, at_ms + 0.1);
      writeNote(at_ms + 0.5);
    }
  }
  void writeEvent(std::uint64_t step, double at_ms) {
    msg::Event event;
    event.step(step);
    write(dds::topics::kEvent, event, at_ms);
  }
  void writeReset(double at_ms) {
    msg::Rewind rewind;
    rewind.take(1);
    rewind.phase(msg::REWIND_COMMIT);
    write(dds::topics::kRewind, rewind, at_ms);
  }

  /// Log times in ms of what a range takes of a topic.
  std::vector<double> taken(const RangeWish& wish, const std::string& topic) {
    if (writer) writer->close();
    writer.reset();
    const mcap::Reader reader(file);
    RecordingRange range(wish, reader, file);
    std::vector<double> times;
    reader.forEachMessage({.topics = {topic}, .start_time_ns = range.startTime(), .end_time_ns = range.endTime()},
                          [&](const mcap::MessageView& message) {
                            if (range.takes(message))
                              times.push_back(static_cast<double>(message.log_time_ns - 1'000'000'000) / 1e6);
                          });
    return times;
  }
  /// What is said of a range that is refused.
  std::string refusal(const RangeWish& wish) {
    try {
      (void)taken(wish, "plant_state");
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }

  using Times = std::vector<double>;
  std::string file;
  std::optional<mcap::Writer> writer;

 private:
  std::filesystem::path folder_;
  std::map<std::string, mcap::ChannelId> channels_;
  mcap::ChannelId probe_{}, note_{};
  std::uint32_t sequence_ = 0;
};

TEST_F(RecordingRangeTest, AllOfItIsTakenWhenNothingIsAsked) {
  writeSteps(0, 3, 0);
  EXPECT_EQ(taken({}, "plant_state"), (Times{0, 1, 2, 3}));
  EXPECT_EQ(taken({}, "note"), (Times{0.5, 1.5, 2.5, 3.5}));
}

TEST_F(RecordingRangeTest, WhatCarriesAStepIsTakenByItWhereverItWasLogged) {
  writeProbe(5, 0);  // ahead of the loop
  writeSteps(0, 6, 1);
  writeProbe(3, 9);  // long after it
  writeProbe(6, 10);
  const RangeWish wish{.from_step = 3, .to_step = 5};
  EXPECT_EQ(taken(wish, "plant_state"), (Times{4, 5, 6}));
  EXPECT_EQ(taken(wish, "joint_command"), (Times{4.1, 5.1, 6.1}));
  EXPECT_EQ(taken(wish, "probe"), (Times{0, 9}));
}

TEST_F(RecordingRangeTest, WhatCarriesNoneIsTakenBetweenTheFirstAndTheLastThatDoes) {
  writeSteps(0, 6, 0);
  EXPECT_EQ(taken({.from_step = 2, .to_step = 4}, "note"), (Times{2.5, 3.5})) << "from state 2 to command 4";
  EXPECT_EQ(taken({.from_step = 5}, "note"), (Times{5.5})) << "the last command is the end";
  EXPECT_EQ(taken({.to_step = 1}, "note"), (Times{0.5}));
}

TEST_F(RecordingRangeTest, TheStepOfAnEventIsNoneThatItBelongsTo) {
  writeEvent(2, 0);  // as of a service that had not heard yet
  writeSteps(0, 2, 1);
  writeEvent(1, 3.05);
  writeSteps(3, 4, 4);
  EXPECT_EQ(taken({.from_step = 2, .to_step = 3}, "event"), (Times{3.05}));
  EXPECT_EQ(taken({.from_step = 2, .to_step = 3}, "plant_state"), (Times{3, 4}));
}

TEST_F(RecordingRangeTest, OfARunThatWasResetTheLastPassIsTaken) {
  writeSteps(0, 4, 0);
  writeReset(10);
  writeSteps(0, 2, 11);
  EXPECT_EQ(taken({.from_step = 1, .to_step = 2}, "plant_state"), (Times{12, 13}));
  EXPECT_EQ(taken({.from_sim_s = 0.002, .to_sim_s = 0.002}, "joint_command"), (Times{12.1}));
  const std::string beyond = refusal({.from_step = 3});
  EXPECT_NE(beyond.find("in its last pass after a reset, are 0 to 2, found 3 to its end"), std::string::npos) << beyond;
}

TEST_F(RecordingRangeTest, SimulatedTimeChoosesTheStepsWithinIt) {
  writeSteps(100, 110, 0);  // 0.2 to 0.22 s
  EXPECT_EQ(taken({.from_sim_s = 0.202, .to_sim_s = 0.206}, "plant_state"), (Times{1, 2, 3})) << "both ends";
  EXPECT_EQ(taken({.from_sim_s = 0.2021, .to_sim_s = 0.2059}, "plant_state"), (Times{2})) << "times between steps";
  EXPECT_EQ(taken({.to_sim_s = 0.2}, "joint_command"), (Times{0.1}));
  EXPECT_EQ(taken({.from_sim_s = 0.0, .to_sim_s = 1e300}, "plant_state").size(), 11U);
}

TEST_F(RecordingRangeTest, ARangeBeyondTheRunIsToldWhatTheRecordingHolds) {
  writeSteps(100, 110, 0);
  const std::string steps = refusal({.from_step = 111});
  EXPECT_NE(steps.find("100 to 110, found 111 to its end"), std::string::npos) << steps;
  EXPECT_NE(refusal({.to_step = 99}).find("100 to 110, found 0 to 99"), std::string::npos);
  const std::string times = refusal({.from_sim_s = 0.3, .to_sim_s = 0.4});
  EXPECT_NE(times.find("from 0.2 to 0.22 s of simulated time, found 0.3 to 0.4"), std::string::npos) << times;
  EXPECT_NE(refusal({.from_sim_s = 0.2001, .to_sim_s = 0.2019}), "") << "no step lies between";
  EXPECT_NE(refusal({.from_s = 1.0}).find("ends 0.010500 s after its first message, found 1"), std::string::npos);
  EXPECT_EQ(taken({.from_step = 110, .to_step = 5000}, "plant_state"), (Times{10})) << "as far as it goes";
}

TEST_F(RecordingRangeTest, ARangeWithinAGapIsToldOfIt) {
  writeSteps(0, 5, 0);
  writeSteps(20, 25, 10);  // a part is missing
  const std::string gap = refusal({.from_step = 8, .to_step = 12});
  EXPECT_NE(gap.find("which are 0 to 25 with gaps (parts may be missing), found 8 to 12"), std::string::npos) << gap;
}

TEST_F(RecordingRangeTest, WithoutStepsThereAreOnlyTimes) {
  writeNote(0);
  writeEvent(7, 1);
  EXPECT_NE(refusal({.from_step = 0}).find("expected samples that carry a step, found none"), std::string::npos);
  EXPECT_NE(refusal({.from_sim_s = 0}).find("expected states of the plant"), std::string::npos);
  EXPECT_EQ(taken({.from_s = 0.001}, "event"), (Times{1}));
}

TEST_F(RecordingRangeTest, RefusesContradictions) {
  writeSteps(0, 4, 0);
  EXPECT_NE(refusal({.from_s = 0.0, .to_step = 3}).find("a range of one kind"), std::string::npos);
  EXPECT_NE(refusal({.to_step = 3, .from_sim_s = 0.0}).find("a range of one kind"), std::string::npos);
  EXPECT_NE(refusal({.from_s = 0.0, .to_sim_s = 1.0}).find("a range of one kind"), std::string::npos);
  EXPECT_NE(refusal({.from_step = 3, .to_step = 2}).find("--to-step: expected a step"), std::string::npos);
  EXPECT_NE(refusal({.from_step = 5, .to_step = 3}).find("--from-step 5, found 3; exchange the two"),
            std::string::npos);
  EXPECT_NE(refusal({.from_step = 9}).find("found 9 to its end; choose"), std::string::npos);
  EXPECT_NE(refusal({.from_sim_s = 1.0}).find("found 1 to its end; choose"), std::string::npos);
  EXPECT_NE(refusal({.from_sim_s = 3, .to_sim_s = 2}).find("--to-sim: expected a time"), std::string::npos);
  EXPECT_NE(refusal({.from_s = 3, .to_s = 2}).find("--to: expected a time"), std::string::npos);
}

}  // namespace
}  // namespace baton
