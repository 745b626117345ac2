/// Lateness in figures: percentiles by nearest rank.
#include "lateness.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace baton {
namespace {

TEST(Lateness, OfNothingIsZero) {
  const Lateness lateness = latenessOf({});
  EXPECT_EQ(lateness.p50_us, 0.0);
  EXPECT_EQ(lateness.p99_us, 0.0);
  EXPECT_EQ(lateness.max_us, 0.0);
}

TEST(Lateness, OfOneMessageIsThatMessage) {
  std::vector<double> values{7.5};
  const Lateness lateness = latenessOf(values);
  EXPECT_EQ(lateness.p50_us, 7.5);
  EXPECT_EQ(lateness.p99_us, 7.5);
  EXPECT_EQ(lateness.max_us, 7.5);
}

TEST(Lateness, IsTheSmallestValueThatEnoughMessagesDoNotExceed) {
  std::mt19937 generator(20);
  std::exponential_distribution<double> distribution(0.01);
  for (std::size_t size = 1; size <= 300; ++size) {
    std::vector<double> values(size);
    std::generate(values.begin(), values.end(), [&] { return distribution(generator); });
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const auto at_share = [&](double share) {
      const auto enough = std::find_if(sorted.begin(), sorted.end(), [&](double value) {
        const auto below = std::upper_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
        return static_cast<double>(below) * 100.0 >= share * static_cast<double>(size);
      });
      return *enough;
    };
    const Lateness lateness = latenessOf(values);
    EXPECT_EQ(lateness.p50_us, at_share(50.0)) << size;
    EXPECT_EQ(lateness.p99_us, at_share(99.0)) << size;
    EXPECT_EQ(lateness.max_us, sorted.back()) << size;
    std::sort(values.begin(), values.end());
    EXPECT_EQ(values, sorted) << "no value may be lost";
  }
}

}  // namespace
}  // namespace baton
