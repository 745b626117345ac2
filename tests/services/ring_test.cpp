/// The latest of a run, in memory.
#include "ring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "support/allocation_guard.hpp"

namespace baton {
namespace {

constexpr std::size_t kPlenty = 1 << 20;
constexpr std::size_t kAll = 1'000'000;

struct Held {
  std::size_t stream;
  std::uint64_t sequence;
  std::vector<std::byte> payload;
  bool operator==(const Held&) const = default;
};

std::vector<std::byte> payloadOf(std::uint64_t sequence, std::size_t size) {
  return std::vector<std::byte>(size, static_cast<std::byte>(sequence * 7));
}

struct Fed {
  Fed(std::uint64_t steps, std::size_t bytes) : ring(steps, bytes) {}

  bool push(std::uint64_t step, std::size_t stream = 0, std::size_t size = 100, std::size_t latched = 0) {
    const std::vector<std::byte> payload = payloadOf(++sequence, size);
    return ring.push({.stream = stream,
                      .sequence = sequence,
                      .log_time_ns = static_cast<std::int64_t>(sequence),
                      .step = step,
                      .latched = latched,
                      .payload = payload});
  }
  [[nodiscard]] std::vector<Held> held() const {
    std::vector<Held> result;
    std::int64_t last = 0;
    ring.older().forEach([&](const auto& sample) {
      result.push_back({sample.head.stream, sample.head.sequence, sample.bytes});
      last = std::max(last, sample.head.log_time_ns);
    });
    ring.forEach([&](const Ring::Sample& sample) {
      EXPECT_GE(sample.log_time_ns, last);
      last = sample.log_time_ns;
      result.push_back({sample.stream, sample.sequence, {sample.payload.begin(), sample.payload.end()}});
    });
    EXPECT_EQ(result.size(), ring.samples());
    return result;
  }
  [[nodiscard]] std::vector<std::uint64_t> sequences() const {
    std::vector<std::uint64_t> result;
    for (const Held& one : held()) result.push_back(one.sequence);
    return result;
  }

  Ring ring;
  std::uint64_t sequence = 0;
};

TEST(Ring, HoldsTheLastSteps) {
  Fed fed(3, kPlenty);
  for (std::uint64_t step = 0; step < 10; ++step) fed.push(step);
  EXPECT_EQ(fed.sequences(), (std::vector<std::uint64_t>{7, 8, 9, 10})) << "of steps 6 to 9";
  EXPECT_EQ(fed.ring.firstStep(), 6u);
}

TEST(Ring, HoldsNoMoreBytesThanItMay) {
  Fed fed(1'000'000, 4000);
  for (std::uint64_t step = 0; step < 500; ++step) fed.push(step);
  EXPECT_LE(fed.ring.bytes(), 4000u);
  const std::vector<std::uint64_t> held = fed.sequences();
  ASSERT_FALSE(held.empty());
  EXPECT_EQ(held.back(), 500u);
  for (std::size_t i = 1; i < held.size(); ++i) EXPECT_EQ(held[i], held[i - 1] + 1) << "the latest, without a gap";
  EXPECT_GE(held.size(), 10u);
}

TEST(Ring, GivesBackExactlyWhatCameWhateverTheSizes) {
  std::mt19937 generator(5);
  Fed fed(40, 8000);
  std::vector<Held> all;
  for (std::uint64_t step = 0; step < 5000; ++step) {
    const std::size_t size = generator() % (step % 50 == 0 ? 3000 : 300);
    ASSERT_TRUE(fed.push(step, step % 5, size));
    all.push_back({step % 5, fed.sequence, payloadOf(fed.sequence, size)});
    if (step % 97 != 0) continue;
    const std::vector<Held> held = fed.held();
    ASSERT_LE(held.size(), all.size());
    ASSERT_TRUE(std::equal(held.rbegin(), held.rend(), all.rbegin())) << step;
  }
}

TEST(Ring, WhatIsLargerThanTheRingIsNotKept) {
  Fed fed(10, 4000);
  fed.push(1);
  EXPECT_FALSE(fed.push(2, 0, 5000));
  EXPECT_EQ(fed.sequences(), (std::vector<std::uint64_t>{1}));
}

TEST(Ring, EventsLastAndOfAStatusTheLatestOfEachWriter) {
  Fed fed(2, kPlenty);
  fed.push(0, 1, 10, kAll);  // 1
  fed.push(0, 2, 10, 1);     // 2
  fed.push(1, 2, 10, 1);     // 3
  fed.push(1, 3, 10, 1);     // 4
  fed.push(2, 1, 10, kAll);  // 5
  fed.push(2);               // 6
  for (std::uint64_t step = 10; step < 13; ++step) fed.push(step);
  EXPECT_EQ(fed.sequences(), (std::vector<std::uint64_t>{1, 3, 4, 5, 7, 8, 9}));
}

TEST(Ring, WhatWasLeftOutLastsAndIsNotInTheRing) {
  Fed fed(2, kPlenty);
  const auto pushInPause = [&](std::uint64_t step) {
    const std::vector<std::byte> payload = payloadOf(++fed.sequence, 10);
    fed.ring.push({.stream = 1,
                   .sequence = fed.sequence,
                   .log_time_ns = static_cast<std::int64_t>(fed.sequence),
                   .step = step,
                   .latched = 1,
                   .is_left_out = true,
                   .payload = payload});
  };
  fed.push(0, 1, 10, 1);  // 1
  fed.push(1);            // 2
  pushInPause(1);         // 3
  fed.push(2);            // 4
  EXPECT_EQ(fed.sequences(), (std::vector<std::uint64_t>{1, 2, 4}));
  for (std::uint64_t step = 10; step < 12; ++step) fed.push(step);  // 5, 6
  EXPECT_EQ(fed.sequences(), (std::vector<std::uint64_t>{3, 5, 6})) << "how things stand since the pause";
}

TEST(Ring, AResetEndsWhatWasDecidedBeforeIt) {
  Ring ring(1, kPlenty);
  std::vector<std::byte> buffer(10'000);
  std::uint64_t sequence = 0;
  const auto push = [&](std::size_t stream, const auto& topic, const auto& message) {
    ring.push({.stream = stream,
               .sequence = ++sequence,
               .log_time_ns = static_cast<std::int64_t>(sequence),
               .step = sequence,
               .latched = kAll,
               .facts = dds::topics::called(topic.name),
               .payload = dds::encode(message, std::span(buffer))});
  };
  msg::Decision decision;
  msg::Rewind rewind;
  push(1, dds::topics::kDecision, decision);         // 1
  push(2, dds::topics::kSwapPlan, msg::SwapPlan());  // 2
  push(3, dds::topics::kEvent, msg::Event());        // 3
  rewind.take(1);
  push(4, dds::topics::kRewind, rewind);  // 4: only prepared
  decision.take(1);
  push(1, dds::topics::kDecision, decision);  // 5: from another writer, and so before the word of its take
  rewind.phase(msg::REWIND_COMMIT);
  push(4, dds::topics::kRewind, rewind);             // 6
  push(2, dds::topics::kSwapPlan, msg::SwapPlan());  // 7
  push(3, dds::topics::kEvent, msg::Event());        // 8
  push(3, dds::topics::kEvent, msg::Event());        // 9
  std::vector<std::uint64_t> older;
  ring.older().forEach([&](const auto& sample) { older.push_back(sample.head.sequence); });
  EXPECT_EQ(older, (std::vector<std::uint64_t>{3, 5, 6, 7}));
}

TEST(Ring, EventsThatNeverEndGiveWayToo) {
  Fed fed(1, 8000);
  for (std::uint64_t step = 0; step < 1000; ++step) fed.push(step, 1, 100, kAll);
  EXPECT_LE(fed.ring.bytes(), 8000u);
  EXPECT_EQ(fed.sequences().back(), 1000u);
}

TEST(Ring, IsEmptyWhenCleared) {
  Fed fed(5, kPlenty);
  fed.push(1, 1, 10, kAll);
  fed.push(10);
  fed.ring.clear();
  EXPECT_EQ(fed.ring.samples(), 0u);
  EXPECT_EQ(fed.ring.bytes(), 0u);
  fed.push(11);
  EXPECT_EQ(fed.sequences(), (std::vector<std::uint64_t>{3}));
}

}  // namespace
}  // namespace baton
