/// When a part is full, and when the disk has no more room.
#include "storage_policy.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

constexpr std::uint64_t kMB = 1'000'000;

TEST(PartIsFull, AtItsSizeOrItsTimeWhicheverComesFirst) {
  RecordingConfig config;
  EXPECT_FALSE(isPartFull(config, 1000 * kMB, 1'000'000)) << "nothing was asked for";
  config.split_bytes = 10 * kMB;
  EXPECT_FALSE(isPartFull(config, 10 * kMB - 1, 1'000'000));
  EXPECT_TRUE(isPartFull(config, 10 * kMB, 0));
  config.split_steps = 500;
  EXPECT_FALSE(isPartFull(config, 0, 499));
  EXPECT_TRUE(isPartFull(config, 0, 500));
}

RecordingConfig withBudget(std::uint64_t max_bytes, bool drops_oldest) {
  RecordingConfig config;
  config.chunk_bytes = 100'000;
  config.max_bytes = max_bytes;
  config.min_free_bytes = 0;
  config.drops_oldest = drops_oldest;
  return config;
}

TEST(Budget, EndsTheRecordingSoEarlyThatTheFinishedFileFits) {
  const RecordingConfig config = withBudget(10 * kMB, false);
  EXPECT_EQ(judgeStorage(config, {.part_bytes = 9 * kMB, .free_bytes = kMB}), StorageVerdict::kGoOn);
  const std::uint64_t last = 9'700'000;
  EXPECT_EQ(judgeStorage(config, {.part_bytes = last, .free_bytes = kMB}), StorageVerdict::kStop);
  EXPECT_GE(last + closingBytes(config, last, 0), config.max_bytes);
}

TEST(Budget, CountsAllParts) {
  const RecordingConfig config = withBudget(10 * kMB, false);
  EXPECT_EQ(judgeStorage(config, {.closed_bytes = 8 * kMB, .part_bytes = kMB, .closed_parts = 2}),
            StorageVerdict::kGoOn);
  EXPECT_EQ(judgeStorage(config, {.closed_bytes = 9 * kMB, .part_bytes = kMB, .closed_parts = 2}),
            StorageVerdict::kStop);
}

TEST(Budget, DropsTheOldestPartWhereThatIsWantedAndThereIsOne) {
  const RecordingConfig config = withBudget(10 * kMB, true);
  EXPECT_EQ(judgeStorage(config, {.closed_bytes = 9 * kMB, .part_bytes = kMB, .closed_parts = 2}),
            StorageVerdict::kDropOldest);
  EXPECT_EQ(judgeStorage(config, {.part_bytes = 10 * kMB, .closed_parts = 0}), StorageVerdict::kStop);
}

TEST(LowDisk, EndsTheRecordingOrDropsTheOldestSoEarlyThatSoMuchIsLeftBehindTheFinishedFile) {
  RecordingConfig config;
  config.min_free_bytes = 50 * kMB;
  const std::uint64_t least = 50 * kMB + closingBytes(config, kMB, 0);
  EXPECT_GT(least, 50 * kMB + config.chunk_bytes) << "the last chunk and the summary";
  EXPECT_EQ(judgeStorage(config, {.part_bytes = kMB, .free_bytes = least}), StorageVerdict::kGoOn);
  const Storage low{.part_bytes = kMB, .closed_parts = 1, .free_bytes = least - 1};
  EXPECT_EQ(judgeStorage(config, low), StorageVerdict::kStop);
  EXPECT_EQ(reachedText(config, low), "recording.min_free_MB, 50, is reached: the disk has 50.4 MB left");
  config.drops_oldest = true;
  EXPECT_EQ(judgeStorage(config, low), StorageVerdict::kDropOldest);
}

TEST(LowDisk, CountsWhatTheLastChunkAndTheSummaryRepeat) {
  RecordingConfig config;
  config.min_free_bytes = 50 * kMB;
  constexpr std::uint64_t kDeclared = 300'000;
  const std::uint64_t least = 50 * kMB + config.chunk_bytes + 2 * kDeclared;
  EXPECT_EQ(judgeStorage(config, {.declared_bytes = kDeclared, .free_bytes = least}), StorageVerdict::kStop);
  EXPECT_EQ(judgeStorage(config, {.declared_bytes = kDeclared, .free_bytes = least + 100'000}), StorageVerdict::kGoOn);
}

TEST(Snapshot, IsWrittenOnlyWhereSoMuchIsLeftBehindIt) {
  constexpr std::uint64_t kDeclared = kMB;  // of a thousand writers: the last chunk and the summary repeat it
  RecordingConfig config;
  config.min_free_bytes = 50 * kMB;
  const std::uint64_t least = 50 * kMB + 20 * kMB + closingBytes(config, 20 * kMB, kDeclared);
  EXPECT_GT(least, 50 * kMB + 20 * kMB + 2 * kDeclared);
  EXPECT_EQ(roomObjection(config, 20 * kMB, kDeclared, least), "");
  const std::string objection = roomObjection(config, 20 * kMB, kDeclared, least - 1);
  EXPECT_NE(objection.find("recording.min_free_MB, 50, has to be left"), std::string::npos) << objection;
  config.min_free_bytes = 0;
  EXPECT_EQ(roomObjection(config, 20 * kMB, kDeclared, 0), "") << "nothing was asked for";
}

TEST(NoPolicy, NeverEndsARecording) {
  RecordingConfig config;
  config.min_free_bytes = 0;
  EXPECT_EQ(judgeStorage(config, {.closed_bytes = 1'000'000 * kMB, .free_bytes = 0}), StorageVerdict::kGoOn);
}

}  // namespace
}  // namespace baton
