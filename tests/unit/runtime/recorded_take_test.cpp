/// Which take of a run counts, and what a file that begins in the middle knows of it.
#include "runtime/recorded_take.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "mcap/reader.hpp"
#include "runtime/latched.hpp"
#include "support/small_recording.hpp"

namespace baton {
namespace {

using test::SmallRecording;
constexpr std::uint64_t kFirst_ns = 1'001'000'000, kEach_ns = 1'000'000;  // log times of SmallRecording

class RecordedTake : public testing::Test {
 protected:
  RecordedTake() {
    std::string name = (std::filesystem::temp_directory_path() / "baton-take-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder = name;
  }
  ~RecordedTake() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  [[nodiscard]] std::filesystem::path write(const std::function<void(SmallRecording&)>& fill) const {
    SmallRecording recording(folder / "a.mcap");
    fill(recording);
    recording.close();
    return folder / "a.mcap";
  }
  [[nodiscard]] Take takeOf(const std::function<void(SmallRecording&)>& fill) const {
    return lastTake(mcap::Reader(write(fill)));
  }

  std::filesystem::path folder;
};

void addStates(SmallRecording& out, const std::vector<std::uint64_t>& steps) {
  msg::PlantState state;
  for (const std::uint64_t step : steps) {
    state.step(step);
    out.add(dds::topics::kPlantState, "plant", state);
  }
}

void addReset(SmallRecording& out, std::uint32_t take, msg::RewindPhase end = msg::REWIND_COMMIT) {
  msg::Rewind rewind;
  rewind.take(take);
  for (const msg::RewindPhase phase : {msg::REWIND_PREPARE, end}) {
    rewind.phase(phase);
    out.add(dds::topics::kRewind, "plant", rewind);
  }
}

TEST_F(RecordedTake, ResetsAreCountedOfWhateverRun) {
  const auto path = write([](SmallRecording& out) {
    addStates(out, {0, 1});
    addReset(out, 1);
    addStates(out, {0});
  });
  EXPECT_EQ(resetsIn(mcap::Reader(path)), 1U);
}

TEST_F(RecordedTake, OfTwoRunsInOneFileNoneIsChosen) {
  const auto path = write([](SmallRecording& out) {
    addStates(out, {0, 1});
    msg::PlantState state;
    out.add(dds::topics::kPlantState, "plant of another run", state);  // merged, or behind it
  });
  try {
    (void)lastTake(mcap::Reader(path));
    FAIL() << "one of them was chosen";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("expected a recording of one run, found the states of 2 plants"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(RecordedTake, ItsNumberIsThatOfItsMessagesAndResetsAreThoseThatTookPlace) {
  const Take take = takeOf([](SmallRecording& out) {
    addStates(out, {0, 1});
    addReset(out, 1, msg::REWIND_CANCEL);
    addReset(out, 2);
    addStates(out, {0});
  });
  EXPECT_EQ(take.number, 2U);
  EXPECT_EQ(take.resets, 1U);
  EXPECT_EQ(take.begin_ns, kFirst_ns + 5 * kEach_ns);
}

TEST_F(RecordedTake, WithoutResetsAndACertificateItBeginsWhereTheStatesGoBack) {
  const Take cut_off = takeOf([](SmallRecording& out) { addStates(out, {0, 1, 2, 0, 1}); });
  EXPECT_EQ(cut_off.begin_ns, kFirst_ns + 3 * kEach_ns);
  EXPECT_EQ(cut_off.resets, 1U);
  const Take certified = takeOf([](SmallRecording& out) {
    addStates(out, {0, 1, 2, 0, 1});
    out.attach("certificate.json", R"({"left_out": [], "streams": []})");
  });
  EXPECT_EQ(certified.begin_ns, 0U) << "there was none to record";
}

/// Two takes, each with what was decided in it.
void addTwoTakes(SmallRecording& out) {
  msg::Decision decision;
  msg::SwapOutcome outcome;
  msg::SwapReport report;
  for (const std::uint32_t take : {0U, 1U}) {
    if (take > 0) addReset(out, take);
    decision.take(take);
    outcome.take(take);
    report.take(take);
    out.add(dds::topics::kDecision, "plant", decision);
    out.add(dds::topics::kSwapPlan, "plant", msg::SwapPlan());
    out.add(dds::topics::kSwapAck, "pd", msg::SwapAck());
    out.add(dds::topics::kSwapOutcome, "plant", outcome);
    out.add(dds::topics::kSwapReport, "plant", report);
    out.add(dds::topics::kEvent, "plant", msg::Event());
    addStates(out, {0});
  }
}

TEST_F(RecordedTake, AFileThatBeginsAfterAResetBeginsWithItAndWithoutWhatItEnded) {
  const mcap::Reader reader(write(addTwoTakes));
  const auto topicsBefore = [&](std::uint64_t message, std::vector<std::string> chosen = {}) {
    std::vector<std::string> topics;
    const mcap::MessageFilter filter{.topics = std::move(chosen), .start_time_ns = kFirst_ns + message * kEach_ns};
    for (const LatchedMessage& one : latchedBefore(reader, filter)) topics.push_back(one.view.channel->topic);
    return topics;
  };
  using Topics = std::vector<std::string>;
  const Topics decided{"decision", "swap_plan", "swap_ack", "swap_outcome", "swap_report", "event"};
  EXPECT_EQ(topicsBefore(7), decided);
  EXPECT_EQ(topicsBefore(8), decided) << "a reset that is only prepared ends nothing";
  EXPECT_EQ(topicsBefore(9), (Topics{"event", "rewind"}));
  Topics of_both{"event", "rewind"};
  of_both.insert(of_both.end(), decided.begin(), decided.end());
  EXPECT_EQ(topicsBefore(15), of_both);
  EXPECT_EQ(topicsBefore(9, {"decision", "event"}), (Topics{"event"})) << "whether or not resets are chosen";
  EXPECT_EQ(topicsBefore(15, {"plant_state"}), (Topics{}));
}

TEST_F(RecordedTake, AFileThatBeginsWithAResetIsOfItsTake) {
  const Take take = takeOf([](SmallRecording& out) {
    msg::Rewind rewind;
    rewind.take(3);
    rewind.phase(msg::REWIND_COMMIT);
    out.add(dds::topics::kRewind, "plant", rewind);
    addStates(out, {5, 6});
  });
  EXPECT_EQ(take.number, 3U);
  EXPECT_EQ(take.begin_ns, kFirst_ns);
}

}  // namespace
}  // namespace baton
