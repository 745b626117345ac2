/// A histogram held against the sorted samples themselves.
#include "time/histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "support/allocation_guard.hpp"

namespace baton {
namespace {

constexpr double kHalfWidth = 1.0 / 128.0;  // of a bucket, relative to its values

std::int64_t nearestRank(const std::vector<std::int64_t>& sorted, double p) {
  const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

/// Spread evenly over the octaves of 1 ns to 4.6 minutes.
std::vector<std::int64_t> manySamples() {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(0.0, 38.0);
  std::vector<std::int64_t> samples(20'000);
  for (std::int64_t& sample : samples) sample = static_cast<std::int64_t>(std::exp2(exponent(random)));
  return samples;
}

TEST(Histogram, EmptySaysZero) {
  const Histogram histogram;
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.min(), 0);
  EXPECT_EQ(histogram.max(), 0);
  EXPECT_EQ(histogram.mean(), 0.0);
  EXPECT_EQ(histogram.quantile(0.5), 0);
}

TEST(Histogram, QuantilesAreThoseOfTheSortedSamplesWithinHalfABucket) {
  std::vector<std::int64_t> samples = manySamples();
  Histogram histogram;
  for (const std::int64_t sample : samples) histogram.record(sample);
  std::sort(samples.begin(), samples.end());
  for (int permille = 0; permille <= 1000; ++permille) {
    const double p = permille / 1000.0;
    const auto exact = static_cast<double>(nearestRank(samples, p));
    ASSERT_NEAR(static_cast<double>(histogram.quantile(p)), exact, kHalfWidth * exact) << p;
  }
}

TEST(Histogram, CountMeanAndExtremesAreExact) {
  const std::vector<std::int64_t> samples = manySamples();
  Histogram histogram;
  for (const std::int64_t sample : samples) histogram.record(sample);
  const auto [smallest, largest] = std::minmax_element(samples.begin(), samples.end());
  const auto sum = std::accumulate(samples.begin(), samples.end(), std::int64_t{0});
  EXPECT_EQ(histogram.count(), samples.size());
  EXPECT_EQ(histogram.min(), *smallest);
  EXPECT_EQ(histogram.max(), *largest);
  EXPECT_DOUBLE_EQ(histogram.mean(), static_cast<double>(sum) / static_cast<double>(samples.size()));
  EXPECT_EQ(histogram.quantile(0.0), *smallest);
  EXPECT_EQ(histogram.quantile(1.0), *largest);
}

TEST(Histogram, SmallValuesAreExact) {
  // Steps, missed samples, single nanoseconds: 0 to 127, each once.
  Histogram histogram;
  for (std::int64_t value = 127; value >= 0; --value) histogram.record(value);
  for (std::int64_t value = 0; value < 128; ++value) {
    EXPECT_EQ(histogram.quantile(static_cast<double>(value + 1) / 128.0), value);
  }
}

TEST(Histogram, EveryValueIsCountedInABucketThatHoldsIt) {
  // Both sides of every bucket's edge in every octave: two such values with a larger one on top.
  for (int octave = 7; octave < 38; ++octave) {
    const std::int64_t width = std::int64_t{1} << (octave - 6);
    for (std::int64_t edge = std::int64_t{1} << octave; edge < std::int64_t{2} << octave; edge += width) {
      for (const std::int64_t value : {edge, edge + width - 1}) {
        Histogram histogram;
        histogram.record(0);
        histogram.record(value);
        histogram.record(Histogram::kLimit);
        const std::int64_t found = histogram.quantile(0.5);
        ASSERT_GE(found, edge);
        ASSERT_LT(found, edge + width);
      }
    }
  }
}

TEST(Histogram, WhatIsBeyondTheLimitIsKnownByCountMeanAndMax) {
  Histogram histogram;
  histogram.record(1'000);
  histogram.record(Histogram::kLimit);
  histogram.record(3 * Histogram::kLimit);
  EXPECT_EQ(histogram.count(), 3U);
  EXPECT_EQ(histogram.min(), 1'000);
  EXPECT_EQ(histogram.max(), 3 * Histogram::kLimit);
  EXPECT_DOUBLE_EQ(histogram.mean(), static_cast<double>(4 * Histogram::kLimit + 1'000) / 3.0);
  EXPECT_EQ(histogram.quantile(0.3), 1'000);
  EXPECT_EQ(histogram.quantile(0.5), 3 * Histogram::kLimit);

  Histogram beyond;
  for (int i = 0; i < 3; ++i) beyond.record(Histogram::kLimit + i);
  EXPECT_EQ(beyond.quantile(0.5), Histogram::kLimit + 2);
}

TEST(Histogram, WhatIsBelowZeroCountsAsZero) {
  Histogram histogram;
  histogram.record(-5);
  histogram.record(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(histogram.count(), 2U);
  EXPECT_EQ(histogram.min(), 0);
  EXPECT_EQ(histogram.max(), 0);
  EXPECT_EQ(histogram.quantile(0.5), 0);
}

TEST(Histogram, OneValueIsEveryQuantile) {
  Histogram histogram;
  for (int i = 0; i < 5; ++i) histogram.record(123'456);
  for (const double p : {0.0, 0.01, 0.5, 0.999, 1.0}) EXPECT_EQ(histogram.quantile(p), 123'456);
}

TEST(Histogram, SharesOutsideZeroToOneAreTheExtremes) {
  Histogram histogram;
  for (const std::int64_t value : {10, 20, 30}) histogram.record(value);
  EXPECT_EQ(histogram.quantile(-1.0), 10);
  EXPECT_EQ(histogram.quantile(2.0), 30);
}

TEST(Histogram, RecordsAndAnswersWithoutAllocating) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  Histogram histogram;
  const test::AllocationGuard guard;
  for (std::int64_t value = 0; value < 100'000; value += 37) histogram.record(value);
  EXPECT_GT(histogram.quantile(0.99), 0);
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace baton
