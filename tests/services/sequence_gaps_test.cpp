#include "bag/sequence_gaps.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

namespace baton {
namespace {

std::uint64_t missingOf(std::initializer_list<std::uint32_t> sequences) {
  SequenceGaps gaps;
  for (const std::uint32_t sequence : sequences) gaps.add(sequence);
  return gaps.missing();
}

TEST(SequenceGaps, CountsWhatIsMissingBetweenTheFirstAndTheLast) {
  EXPECT_EQ(missingOf({}), 0U);
  EXPECT_EQ(missingOf({7}), 0U);
  EXPECT_EQ(missingOf({1, 2, 3}), 0U);
  EXPECT_EQ(missingOf({1, 4, 6}), 3U);
}

TEST(SequenceGaps, TheOrderInTheFileDoesNotMatter) {
  EXPECT_EQ(missingOf({1, 4, 2, 3}), 0U);
  EXPECT_EQ(missingOf({5, 1, 3}), 2U);
  EXPECT_EQ(missingOf({9, 8, 7}), 0U);
  EXPECT_EQ(missingOf({1, 10, 5, 3, 7}), 5U);
}

TEST(SequenceGaps, AMessageThatComesTwiceFillsOneHole) {
  EXPECT_EQ(missingOf({1, 1, 4, 4, 2, 2}), 1U);
  EXPECT_EQ(missingOf({0, 0, 0}), 0U);
}

TEST(SequenceGaps, TheNumberMayWrap) {
  EXPECT_EQ(missingOf({0xFFFF'FFFE, 0xFFFF'FFFF, 0, 1}), 0U);
  EXPECT_EQ(missingOf({0xFFFF'FFFE, 1, 0xFFFF'FFFF}), 1U);
}

}  // namespace
}  // namespace baton
