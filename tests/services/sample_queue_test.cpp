/// From the receive threads to the thread that writes: bounded, in order, and closed without losing anything.
#include "sample_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <thread>
#include <vector>

namespace baton {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kNoWait{0};
constexpr milliseconds kGenerous{30'000};  // a bound for a test that fails, never waited out by one that passes

struct Sample {
  std::vector<std::byte> payload;
  dds::RawSample raw;
};

/// A sample recognisable by its sequence number.
Sample sampleOf(std::uint64_t sequence, std::size_t size = 16) {
  Sample sample{std::vector<std::byte>(size, static_cast<std::byte>(sequence)), {}};
  sample.raw.payload = sample.payload;
  sample.raw.sequence = sequence;
  sample.raw.source_timestamp_ns = static_cast<std::int64_t>(1000 * sequence);
  sample.raw.writer.bytes.fill(static_cast<std::uint8_t>(sequence));
  return sample;
}

bool push(SampleQueue& queue, std::uint32_t topic, std::uint64_t sequence, std::size_t size = 16) {
  const Sample sample = sampleOf(sequence, size);
  return queue.push(topic, sample.raw);
}

TEST(SampleQueue, ASampleWithoutATimeOfItsWriterHasTheTimeItCame) {
  SampleQueue queue(1 << 20, 1);
  Sample sample = sampleOf(1);
  sample.raw.source_timestamp_ns = -1;
  ASSERT_TRUE(queue.push(0, sample.raw));
  SampleQueue::Batch batch;
  ASSERT_TRUE(queue.take(batch, kNoWait));
  ASSERT_EQ(batch.entries.size(), 1u);
  EXPECT_GT(batch.entries[0].log_time_ns, 0);
  EXPECT_EQ(batch.entries[0].source_timestamp_ns, batch.entries[0].log_time_ns);
}

TEST(SampleQueue, SamplesComeOutAsTheyWentIn) {
  SampleQueue queue(1 << 20, 1);
  for (std::uint64_t i = 1; i <= 100; ++i) ASSERT_TRUE(push(queue, static_cast<std::uint32_t>(i % 7), i, i));
  SampleQueue::Batch batch;
  ASSERT_TRUE(queue.take(batch, kNoWait));
  ASSERT_EQ(batch.entries.size(), 100u);
  for (std::uint64_t i = 1; i <= 100; ++i) {
    const SampleQueue::Entry& entry = batch.entries[i - 1];
    const Sample expected = sampleOf(i, i);
    EXPECT_EQ(entry.topic, i % 7);
    EXPECT_EQ(entry.sequence, i);
    EXPECT_EQ(entry.source_timestamp_ns, expected.raw.source_timestamp_ns);
    EXPECT_EQ(entry.writer, expected.raw.writer);
    EXPECT_TRUE(std::ranges::equal(batch.payload(entry), expected.payload));
  }
}

TEST(SampleQueue, LogTimesAreThoseOfTheClockOfTheRun) {
  const dds::WallClock clock(1'000'000'000'000'000'000);  // which the machine's wall clock need not agree with
  SampleQueue queue(1 << 20, 1, clock);
  const std::int64_t before = clock.now();
  push(queue, 0, 1);
  push(queue, 0, 2);
  const std::int64_t after = clock.now();
  SampleQueue::Batch batch;
  ASSERT_TRUE(queue.take(batch, kNoWait));
  ASSERT_EQ(batch.entries.size(), 2u);
  EXPECT_LE(before, batch.entries[0].log_time_ns);
  EXPECT_LE(batch.entries[0].log_time_ns, batch.entries[1].log_time_ns);
  EXPECT_LE(batch.entries[1].log_time_ns, after);
}

TEST(SampleQueue, ABatchIsEmptiedBeforeItIsFilledAgain) {
  SampleQueue queue(1 << 20, 1);
  SampleQueue::Batch batch;
  for (std::uint64_t i = 1; i <= 5; ++i) {
    push(queue, 0, i);
    ASSERT_TRUE(queue.take(batch, kNoWait));
    ASSERT_EQ(batch.entries.size(), 1u);
    EXPECT_EQ(batch.entries[0].sequence, i);
    EXPECT_EQ(batch.payloads.size(), 16u);
  }
  ASSERT_TRUE(queue.take(batch, kNoWait)) << "empty, but still open";
  EXPECT_TRUE(batch.entries.empty());
  EXPECT_TRUE(batch.payloads.empty());
}

TEST(SampleQueue, HoldsItsBytesAndNotOneMore) {
  SampleQueue queue(100, 1);
  EXPECT_TRUE(push(queue, 0, 1, 60));
  EXPECT_TRUE(push(queue, 0, 2, 40));
  EXPECT_FALSE(push(queue, 0, 3, 1));
  EXPECT_EQ(queue.depth().samples, 2u);
  EXPECT_EQ(queue.depth().bytes, 100u);
  SampleQueue::Batch batch;
  ASSERT_TRUE(queue.take(batch, kNoWait));
  ASSERT_EQ(batch.entries.size(), 2u);
  EXPECT_EQ(queue.depth().samples, 0u);
  EXPECT_TRUE(push(queue, 0, 4, 100)) << "taking makes room";
}

TEST(SampleQueue, WhatFindsNoRoomIsToldByWriterInOnePiece) {
  SampleQueue queue(100, 1);
  const auto of = [](std::uint8_t writer, std::uint64_t sequence, std::size_t size) {
    Sample sample = sampleOf(sequence, size);
    sample.raw.writer.bytes.fill(writer);
    return sample;
  };
  EXPECT_TRUE(queue.push(3, of(1, 10, 90).raw));
  EXPECT_FALSE(queue.push(3, of(1, 11, 11).raw));
  EXPECT_FALSE(queue.push(3, of(1, 12, 1).raw)) << "it would fit, but lies behind one that did not";
  EXPECT_FALSE(queue.push(4, of(2, 7, 1).raw));
  SampleQueue::Batch batch;
  ASSERT_TRUE(queue.take(batch, kNoWait));
  ASSERT_EQ(batch.entries.size(), 1u);
  ASSERT_EQ(batch.drops.size(), 2u);
  EXPECT_EQ(batch.drops[0].topic, 3u);
  EXPECT_EQ(batch.drops[0].writer, of(1, 0, 1).raw.writer);
  EXPECT_EQ(batch.drops[0].first_sequence, 11u);
  EXPECT_EQ(batch.drops[0].last_sequence, 12u);
  EXPECT_EQ(batch.drops[1].topic, 4u);
  EXPECT_EQ(batch.drops[1].first_sequence, 7u);
  ASSERT_TRUE(queue.push(3, of(1, 13, 1).raw));
  ASSERT_TRUE(queue.take(batch, kNoWait));
  EXPECT_TRUE(batch.drops.empty()) << "told once";
}

TEST(SampleQueue, WhatHasHalfOfItLeavesTheRestItsRoom) {
  using enum SampleQueue::Share;
  SampleQueue queue(100, 1);
  const auto push = [&](std::uint64_t sequence, std::size_t size, SampleQueue::Share share) {
    return queue.push(0, sampleOf(sequence, size).raw, share);
  };
  EXPECT_TRUE(push(1, 50, kHalf));
  EXPECT_FALSE(push(2, 1, kHalf));
  EXPECT_TRUE(push(3, 40, kWhole)) << "only the half is full";
  EXPECT_FALSE(push(4, 11, kWhole));
  SampleQueue::Batch batch;
  ASSERT_TRUE(queue.take(batch, kNoWait));
  ASSERT_EQ(batch.drops.size(), 2u);
  EXPECT_TRUE(push(5, 60, kWhole));
  EXPECT_FALSE(push(6, 1, kHalf)) << "what is not of its share takes its room as well";
  ASSERT_TRUE(queue.take(batch, kNoWait));
  EXPECT_TRUE(push(7, 50, kHalf)) << "taking makes room";
}

TEST(SampleQueue, LogTimesNeverDecreaseAcrossTopicsAndBatches) {
  SampleQueue queue(1 << 20, 1);
  SampleQueue::Batch batch;
  std::int64_t last = 0;
  for (std::uint64_t i = 1; i <= 3000; ++i) {
    push(queue, static_cast<std::uint32_t>(i % 5), i);
    if (i % 100 != 0) continue;
    ASSERT_TRUE(queue.take(batch, kNoWait));
    for (const SampleQueue::Entry& entry : batch.entries) {
      EXPECT_GE(entry.log_time_ns, last);
      last = entry.log_time_ns;
    }
  }
  EXPECT_GT(last, 1'600'000'000'000'000'000) << "wall clock, nanoseconds since 1970";
}

TEST(SampleQueue, ClosedItTakesNoNoticeOfNewSamplesAndHandsOutTheOldOnes) {
  SampleQueue queue(1 << 20, 100);
  push(queue, 0, 1);
  queue.close();
  EXPECT_TRUE(push(queue, 0, 2)) << "nothing was dropped that anybody still wants";
  SampleQueue::Batch batch;
  EXPECT_TRUE(queue.take(batch, kGenerous)) << "closed, but not empty";
  ASSERT_EQ(batch.entries.size(), 1u);
  EXPECT_FALSE(queue.take(batch, kGenerous));
  EXPECT_TRUE(batch.entries.empty());
  EXPECT_FALSE(queue.take(batch, kGenerous)) << "and stays so";
}

TEST(SampleQueue, ClosingWakesTheWriter) {
  SampleQueue queue(1 << 20, 100);
  std::thread closer([&] { queue.close(); });
  SampleQueue::Batch batch;
  EXPECT_FALSE(queue.take(batch, kGenerous));
  closer.join();
}

TEST(SampleQueue, EnoughSamplesWakeTheWriterBeforeItsTime) {
  constexpr std::size_t kWake = 10;
  SampleQueue queue(1 << 20, kWake);
  std::thread pusher([&] {
    for (std::uint64_t i = 1; i <= kWake; ++i) push(queue, 0, i);
  });
  SampleQueue::Batch batch;
  EXPECT_TRUE(queue.take(batch, std::chrono::hours(1)));
  EXPECT_EQ(batch.entries.size(), kWake);
  pusher.join();
}

TEST(SampleQueue, ManyThreadsLoseNothingAndKeepTheirOwnOrder) {
  constexpr std::uint64_t kEach = 5000;
  constexpr std::uint32_t kThreads = 3;
  SampleQueue queue(std::numeric_limits<std::size_t>::max(), 64);
  std::vector<std::thread> pushers;
  for (std::uint32_t topic = 0; topic < kThreads; ++topic) {
    pushers.emplace_back([&queue, topic] {
      for (std::uint64_t i = 1; i <= kEach; ++i) push(queue, topic, i);
    });
  }
  std::thread closer([&] {
    for (std::thread& pusher : pushers) pusher.join();
    queue.close();
  });
  SampleQueue::Batch batch;
  std::vector<std::uint64_t> last(kThreads, 0);
  std::int64_t last_time = 0;
  while (queue.take(batch, kGenerous)) {
    for (const SampleQueue::Entry& entry : batch.entries) {
      EXPECT_EQ(entry.sequence, ++last[entry.topic]);
      EXPECT_EQ(batch.payload(entry).front(), static_cast<std::byte>(entry.sequence));
      EXPECT_GE(entry.log_time_ns, last_time);
      last_time = entry.log_time_ns;
    }
  }
  closer.join();
  EXPECT_EQ(last, std::vector<std::uint64_t>(kThreads, kEach));
}

}  // namespace
}  // namespace baton
