// What a writer's account says about a file that begins in the middle of the run: which losses are its own.
#include <gtest/gtest.h>

#include <array>

#include "stream.hpp"

namespace baton {
namespace {

class RecorderStream : public ::testing::Test {
 protected:
  RecorderStream() { stream_.received = &ledger_.streamOf({"topic", dds::Guid{}}); }

  std::uint64_t comes(std::uint64_t sequence, std::uint64_t step) {
    EXPECT_TRUE(ledger_.book(*stream_.received, sequence, std::array<std::byte, 4>{}));
    return stream_.booked(step);
  }

  Ledger ledger_{{}};
  Stream stream_;
};

TEST_F(RecorderStream, WithoutLossesThereIsNothingToExcuse) {
  EXPECT_EQ(comes(1, 10), 0U);
  EXPECT_EQ(comes(2, 20), 0U);
  EXPECT_EQ(stream_.excusedIn(0, 0), 0U);
  EXPECT_EQ(stream_.excusedIn(15, 0), 0U);
}

TEST_F(RecorderStream, AStreamThatBeginsInAGapOwesItToTheFileItBeganIn) {
  EXPECT_EQ(comes(4, 50), 0U) << "none is missing between two that came";
  EXPECT_EQ(stream_.excusedIn(20, 0), 0U) << "the file was open: the first three may have been sent since it began";
  EXPECT_EQ(stream_.excusedIn(50, 0), 0U) << "it began at that very step";
  EXPECT_EQ(stream_.excusedIn(51, 0), 3U) << "a later file has no part in it";
}

TEST_F(RecorderStream, AGapOwesItToTheFileItWasNoticedIn) {
  EXPECT_EQ(comes(1, 10), 0U);
  EXPECT_EQ(comes(5, 50), 3U);
  EXPECT_EQ(comes(6, 60), 0U) << "told once";
  EXPECT_EQ(stream_.excusedIn(20, 0), 0U);
  EXPECT_EQ(stream_.excusedIn(55, 0), 3U);
  EXPECT_EQ(stream_.excusedIn(55, 3), 0U) << "its samples are on both sides of the gap";
}

TEST_F(RecorderStream, WhatFoundNoRoomIsOwedToTheFileOfThatTime) {
  comes(1, 10);
  ledger_.dropped(*stream_.received, 2, 4);
  stream_.dropped(50);
  EXPECT_EQ(comes(5, 200), 3U);
  EXPECT_EQ(stream_.excusedIn(40, 0), 0U);
  EXPECT_EQ(stream_.excusedIn(100, 0), 3U) << "that the next sample came later makes it no loss of a later file";
  EXPECT_EQ(comes(8, 300), 2U);
  EXPECT_EQ(stream_.excusedIn(250, 0), 0U) << "a gap of its own";
}

TEST_F(RecorderStream, ALaterGapTakesTheExcuseFromAnEarlierOne) {
  comes(4, 50);
  comes(9, 150);
  EXPECT_EQ(stream_.excusedIn(100, 0), 0U) << "which of the missing are older than the file cannot be told";
  EXPECT_EQ(stream_.excusedIn(151, 0), 7U);
}

}  // namespace
}  // namespace baton
