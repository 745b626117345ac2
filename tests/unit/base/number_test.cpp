#include "base/number.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace baton {
namespace {

TEST(Number, MayHaveEitherSign) {
  EXPECT_EQ(numberIn<double>("+0.5"), 0.5);
  EXPECT_EQ(numberIn<double>("-0.5"), -0.5);
  EXPECT_EQ(numberIn<double>("+1e-3"), 1e-3);
  EXPECT_EQ(numberIn<double>(".5"), 0.5);
  EXPECT_EQ(numberIn<std::int64_t>("+1"), 1);
  EXPECT_EQ(numberIn<std::uint64_t>("+18446744073709551615"), UINT64_MAX);
}

TEST(Number, IsTheWholeTextAndFinite) {
  for (const char* text : {"", "+", "-", "++1", "+-1", "-+1", " 1", "1 ", "1x", "0,5", "nan", "inf", "+inf", "1e999"}) {
    EXPECT_FALSE(numberIn<double>(text)) << text;
  }
  for (const char* text : {"1.0", "+1.5", "0x10", "-1", "+", "1,5"})
    EXPECT_FALSE(numberIn<std::uint64_t>(text)) << text;
}

TEST(Number, WithACommaIsToldOfThePoint) {
  EXPECT_EQ(commaHint("0,5"), "; the decimal sign is a point: 0.5");
  EXPECT_EQ(commaHint("+1,5e3"), "; the decimal sign is a point: +1.5e3");
  for (const char* text : {"", "1", "0.5", ",", "1,2,3", "0.5,1", "a,b", "1, 2"})
    EXPECT_EQ(commaHint(text), "") << text;
}

}  // namespace
}  // namespace baton
