/// What of a writer's numbers counts as lost, and what is no sample or was there before its writer was found.
#include "booking.hpp"

#include <gtest/gtest.h>

#include <array>

#include "certificate.hpp"

namespace baton {
namespace {

class Booking : public testing::Test {
 protected:
  Booking() {
    stream_.received = &ledger_.streamOf({"topic", dds::Guid{}});
    stream_.found_ns = kFound_ns;
  }
  /// @param after_ns  its writer was found.
  bool comes(std::uint64_t sequence, std::int64_t after_ns, bool has_data = true) {
    SampleQueue::Entry entry;
    entry.sequence = sequence;
    entry.log_time_ns = kFound_ns + after_ns;
    entry.source_timestamp_ns = entry.log_time_ns + writers_clock_ns_;
    entry.has_data = has_data;
    return book(ledger_, stream_, entry, std::array<std::byte, 4>{});
  }
  [[nodiscard]] std::uint64_t missing() const { return stream_.received->second.missing; }

  static constexpr std::int64_t kFound_ns = 1'700'000'000'000'000'000, kHour_ns = 3'600'000'000'000;
  Ledger ledger_{{}};
  Stream stream_;
  std::int64_t writers_clock_ns_ = 0;  // ahead of ours
};

TEST_F(Booking, HolesInWhatAWriterKeptForLateJoinersAreNoLoss) {
  stream_.lasts = true;
  EXPECT_TRUE(comes(1, 10));
  EXPECT_TRUE(comes(6, 60));
  EXPECT_EQ(missing(), 0U);
  EXPECT_TRUE(comes(8, kHistoryPatience_ns)) << "sent since it was found";
  EXPECT_EQ(missing(), 1U);
}

TEST_F(Booking, TheClockOfAWriterNeitherHidesALossNorMakesOne) {
  for (const std::int64_t clock_ns : {-kHour_ns, kHour_ns, -kFound_ns}) {
    SCOPED_TRACE(clock_ns);
    ledger_ = Ledger{{}};
    stream_.received = &ledger_.streamOf({"topic", dds::Guid{}});
    stream_.lasts = true;
    writers_clock_ns_ = clock_ns;
    EXPECT_TRUE(comes(1, 10));
    EXPECT_TRUE(comes(6, 60));
    EXPECT_EQ(missing(), 0U) << "kept for late joiners";
    EXPECT_TRUE(comes(9, kHour_ns / 2));
    EXPECT_EQ(missing(), 2U) << "sent since it was found";
  }
}

TEST_F(Booking, OfAWriterThatKeepsNothingEveryHoleIsALoss) {
  EXPECT_TRUE(comes(1, 10));
  EXPECT_TRUE(comes(6, 60));
  EXPECT_EQ(missing(), 4U);
}

TEST_F(Booking, AnInstanceThatIsDisposedOfIsNeitherKeptNorMissed) {
  EXPECT_TRUE(comes(1, 1100));
  EXPECT_FALSE(comes(2, 1200, false));
  EXPECT_TRUE(comes(3, 1300));
  EXPECT_EQ(missing(), 0U);
  EXPECT_FALSE(comes(6, 1400, false)) << "4 and 5 never came";
  EXPECT_EQ(missing(), 2U);
  EXPECT_EQ(stream_.received->second.count, 2U);
}

TEST_F(Booking, WhatCameAlreadyIsNotKeptAgain) {
  EXPECT_TRUE(comes(5, 1100));
  EXPECT_FALSE(comes(5, 1100));
  EXPECT_FALSE(comes(4, 1050, false));
  EXPECT_EQ(missing(), 0U);
}

TEST_F(Booking, AStatusOfSomebodyElseIsATopicLikeAnyOther) {
  stream_.received = &ledger_.streamOf({"battery_status", dds::Guid{}});
  EXPECT_TRUE(comes(1, 1100));
  EXPECT_TRUE(comes(4, 1200));
  EXPECT_EQ(ledger_.missing(), 2U);
  ASSERT_EQ(ledger_.gaps().size(), 1U);
  EXPECT_EQ(ledger_.problemsSoFar().size(), 1U);
}

TEST_F(Booking, TheCertificateSaysHowManyNumbersHadNoSample) {
  EXPECT_TRUE(comes(1, 1100));
  EXPECT_FALSE(comes(2, 1200, false));
  EXPECT_TRUE(comes(3, 1300));
  Certificate certificate(ledger_, {.run_is_over = false});
  certificate.add(stream_, {.first_sequence = 1, .last_sequence = 3, .count = 2});
  EXPECT_TRUE(certificate.isComplete());
  const nlohmann::json row = nlohmann::json::parse(certificate.text()).at("streams").at(0);
  EXPECT_EQ(row.at("left_out"), 1);
  EXPECT_EQ(row.at("missing"), 0);
}

}  // namespace
}  // namespace baton
