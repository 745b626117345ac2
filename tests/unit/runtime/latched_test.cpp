/// What late joiners are given.
#include "runtime/latched.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

#include "dds/topics.hpp"
#include "mcap/reader.hpp"
#include "mcap/writer.hpp"

namespace baton {
namespace {

const mcap::StringMap kLatched{{"qos", "reliability: true\ndurability: true\nkeyed: false\n"}};
const mcap::StringMap kVolatile{{"qos", "reliability: true\ndurability: false\nkeyed: false\n"}};

mcap::ByteView bytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

TEST(LatchedDepth, IsWhatTheWriterKeeps) {
  EXPECT_EQ(latchedDepth("service_status", kLatched), 1U) << "Baton's profiles";
  EXPECT_EQ(latchedDepth("event", kLatched), 1024U);
  EXPECT_EQ(latchedDepth("swap_request", kLatched), 0U) << "whoever has asked has left";
  EXPECT_EQ(latchedDepth("sim_request", kLatched), 0U);
  EXPECT_EQ(latchedDepth("launch_request", kLatched), 32U) << "what was launched, nothing else says";
  const mcap::StringMap reset{{"type", "baton::msg::Rewind"}, {"qos", kVolatile.at("qos")}};
  EXPECT_EQ(latchedDepth("rewind", reset), 1U) << "of which take it is";
  EXPECT_EQ(latchedDepth("rewind", kVolatile), 0U) << "of another type";
  EXPECT_EQ(latchedDepth("plant_state", {}), 0U);
  EXPECT_EQ(latchedDepth("event", kVolatile), 0U) << "a foreign topic of that name";
  EXPECT_EQ(latchedDepth("map", kLatched), 1U) << "no depth is recorded: the last one";
  EXPECT_EQ(latchedDepth("map", kVolatile), 0U);
  EXPECT_EQ(latchedDepth("map", {}), 0U);
  EXPECT_EQ(latchedDepth("map", {{"qos_policies", "durability: transient_local\ndepth: 5\n"}}), 5U);
  EXPECT_GT(latchedDepth("map", {{"qos_policies", "durability: transient_local\nhistory: keep_all\n"}}), 1'000'000U);
}

TEST(LatchedDepth, OfARosBagIsThatOfAllItsPublishers) {
  const auto depthOf = [](const std::string& profiles) {
    return latchedDepth("tf_static", {{"offered_qos_profiles", profiles}});
  };
  const std::string latched = "- history: 1\n  depth: 3\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 9\n";
  const std::string worded = "- history: keep_last\n  depth: 1\n  durability: transient_local\n";
  EXPECT_EQ(depthOf(latched), 3U);
  EXPECT_EQ(depthOf(latched + worded), 4U);
  EXPECT_EQ(depthOf("- history: 1\n  depth: 10\n  durability: 2\n"), 0U);
  EXPECT_EQ(depthOf("- history: 1\n  depth: 10\n  durability: 2\n" + worded), 1U);
  EXPECT_GT(depthOf("- history: keep_all\n  depth: 0\n  durability: transient_local\n"), 1'000'000U);
  EXPECT_EQ(depthOf(""), 0U);
}

TEST(LatchedDepth, OfALatchingPublisherOfRos1IsOne) {
  EXPECT_EQ(latchedDepth("/tf_static", {{"latching", "1"}, {"callerid", "/map"}, {"type", "tf2_msgs/TFMessage"}}), 1U);
  EXPECT_EQ(latchedDepth("/map", {{"latching", "true"}}), 1U);
  EXPECT_EQ(latchedDepth("/map", {{"latching", "0"}}), 0U);
  EXPECT_EQ(latchedDepth("/map", {{"latching", ""}}), 0U);
}

struct Kept {
  explicit Kept(std::size_t max_bytes = 1000) : samples(max_bytes) {}
  void keep(std::size_t stream, const std::string& instance, std::size_t depth) {
    samples.keep(stream, instance, depth, ++last, bytesOf("0123456789"));
  }
  [[nodiscard]] std::vector<int> held() const {
    std::vector<int> heads;
    samples.forEach([&](const auto& sample) { heads.push_back(sample.head); });
    EXPECT_EQ(heads.size(), samples.size());
    EXPECT_EQ(samples.bytes(), heads.size() * 10);
    return heads;
  }
  LatchedSamples<int> samples;
  int last = 0;
};

TEST(LatchedSamples, TheLatestOfEachStreamAndInstanceAreKept) {
  Kept kept;
  kept.keep(1, "", 2);   // 1
  kept.keep(2, "", 1);   // 2
  kept.keep(1, "", 2);   // 3
  kept.keep(1, "", 2);   // 4
  kept.keep(2, "", 1);   // 5
  kept.keep(3, "a", 1);  // 6
  kept.keep(3, "b", 1);  // 7
  kept.keep(3, "a", 1);  // 8
  kept.keep(4, "", 0);   // 9: of a volatile topic
  EXPECT_EQ(kept.held(), (std::vector<int>{3, 4, 5, 7, 8}));
  kept.samples.clear();
  EXPECT_TRUE(kept.held().empty());
}

TEST(LatchedSamples, WhereMemoryRunsOutTheOldestGoAndTheLatestOfEachStay) {
  Kept kept(50);
  kept.keep(1, "", 1);                                  // 1: the only word of its writer
  for (int i = 0; i < 20; ++i) kept.keep(2, "", 1000);  // 2 to 21
  EXPECT_EQ(kept.held(), (std::vector<int>{1, 18, 19, 20, 21}));
}

TEST(LatchedSamples, ForeignOnesTakeNoMoreThanTheirShare) {
  LatchedSamples<int> samples(1000, 30);
  const dds::TopicFacts event = dds::topics::kEvent;
  for (int i = 0; i < 5; ++i) {
    samples.keep(static_cast<std::size_t>(i), "", 1, i, bytesOf("0123456789"));
    samples.keep(10, "", 8, 10 + i, bytesOf("0123456789"), &event);
  }
  std::vector<int> held;
  samples.forEach([&](const auto& sample) { held.push_back(sample.head); });
  EXPECT_EQ(held, (std::vector<int>{0, 10, 1, 11, 2, 12, 13, 14}));
  EXPECT_EQ(samples.givenUp(), 2U);
  samples.keep(0, "", 2, 20, bytesOf("01234"));
  EXPECT_EQ(samples.bytes(), 75U) << "its own history goes first";
  EXPECT_EQ(samples.givenUp(), 2U);
}

TEST(LatchedSamples, OfThoseThatMayGoTheOldestGoesFirst) {
  Kept kept(40);
  kept.keep(1, "", 2);  // 1
  kept.keep(2, "", 2);  // 2
  kept.keep(2, "", 2);  // 3: 2 may go
  kept.keep(1, "", 2);  // 4: 1 may go too
  kept.keep(3, "", 2);  // 5
  EXPECT_EQ(kept.held(), (std::vector<int>{2, 3, 4, 5}));
  kept.keep(2, "", 2);  // 6: 2 goes by its depth, 3 may go
  kept.keep(4, "", 2);  // 7
  EXPECT_EQ(kept.held(), (std::vector<int>{4, 5, 6, 7}));
  kept.keep(5, "", 2);  // 8: nothing may go
  EXPECT_EQ(kept.held(), (std::vector<int>{4, 5, 6, 7, 8}));
}

class LatchedBefore : public testing::Test {
 protected:
  LatchedBefore() {
    std::string name = (std::filesystem::temp_directory_path() / "baton-latched-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder = name;
    mcap::Writer writer(folder / "a.mcap");
    const auto keyed = writer.addSchema("K", "omgidl", bytesOf("struct K { @key octet id; octet value; };"));
    const auto map = writer.addChannel("map", "cdr", mcap::kNoSchema, kLatched);
    const auto rate = writer.addChannel("rate", "cdr", mcap::kNoSchema, kVolatile);
    const auto robots = writer.addChannel("robots", "cdr", keyed, kLatched);
    std::uint32_t sequence = 0;
    const auto write = [&](mcap::ChannelId channel, std::uint64_t time, std::vector<int> payload = {}) {
      std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
      for (const int one : payload) bytes.push_back(static_cast<std::byte>(one));
      writer.write(channel, ++sequence, time, time, bytes);
    };
    write(map, 10);             // 1
    write(robots, 11, {1, 0});  // 2
    write(rate, 12);            // 3
    write(robots, 13, {2, 0});  // 4
    write(robots, 14, {1, 1});  // 5
    write(map, 15);             // 6
    write(map, 20);             // 7
    writer.close();
  }
  ~LatchedBefore() override { std::filesystem::remove_all(folder); }

  [[nodiscard]] std::vector<std::uint32_t> before(const mcap::MessageFilter& filter) const {
    const mcap::Reader reader(folder / "a.mcap");
    std::vector<std::uint32_t> sequences;
    for (const LatchedMessage& one : latchedBefore(reader, filter)) {
      sequences.push_back(one.view.sequence);
      EXPECT_EQ(one.view.data.data(), one.bytes.data());
    }
    return sequences;
  }
  using Sequences = std::vector<std::uint32_t>;
  std::filesystem::path folder;
};

TEST_F(LatchedBefore, IsWhatALateJoinerGetsOfEachInstance) {
  EXPECT_EQ(before({.start_time_ns = 20}), (Sequences{4, 5, 6})) << "of the robots one sample each, of map the last";
  EXPECT_EQ(before({.start_time_ns = 15}), (Sequences{1, 4, 5})) << "what comes at the beginning is not before it";
  EXPECT_EQ(before({.start_time_ns = 14}), (Sequences{1, 2, 4}));
}

TEST_F(LatchedBefore, IsOfTheChosenTopicsOnlyAndNothingAtTheBeginning) {
  EXPECT_EQ(before({.topics = {"map"}, .start_time_ns = 20}), (Sequences{6}));
  EXPECT_EQ(before({.topics = {"rate"}, .start_time_ns = 20}), (Sequences{}));
  EXPECT_EQ(before({}), (Sequences{}));
  EXPECT_EQ(before({.start_time_ns = 10}), (Sequences{}));
}

}  // namespace
}  // namespace baton
