/// The functions are right, and the same bits as ever: these bits are part of every run's hash.
#include "base/elementary.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/splitmix64.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A number in [-bound, bound], the same sequence on every machine.
class Arguments {
 public:
  double next(double bound) {
    const std::uint64_t bits = splitmix(stream_ += kSplitmixStep);
    return bound * (static_cast<double>(bits >> 11) * 0x1p-52 - 1.0);
  }

 private:
  std::uint64_t stream_ = 1;
};

/// A chain over the bits of `count` results.
template <class Function>
std::uint64_t bitsOf(double bound, Function function) {
  Arguments arguments;
  std::uint64_t chain = 0;
  for (int i = 0; i < 100'000; ++i) chain = splitmix(chain ^ std::bit_cast<std::uint64_t>(function(arguments, bound)));
  return chain;
}

/// Two units in the last place of a result of about this size: one of ours, one of the C library's.
void expectClose(double value, double expected) {
  EXPECT_NEAR(value, expected, 2.0 * std::numeric_limits<double>::epsilon() * std::abs(expected));
}

TEST(Elementary, AgreesWithTheCLibrary) {
  Arguments arguments;
  for (int i = 0; i < 10'000; ++i) {
    const double x = arguments.next(20.0), y = arguments.next(3.0);
    SCOPED_TRACE(testing::Message() << "x = " << x << ", y = " << y);
    expectClose(elementary::sin(x), std::sin(x));
    expectClose(elementary::cos(x), std::cos(x));
    expectClose(elementary::sincos(x).sine, std::sin(x));
    expectClose(elementary::sincos(x).cosine, std::cos(x));
    expectClose(elementary::tanh(x), std::tanh(x));
    expectClose(elementary::atan2(y, x), std::atan2(y, x));
    expectClose(elementary::hypot(x, y), std::hypot(x, y));
  }
}

TEST(Elementary, KeepsSpecialValues) {
  EXPECT_EQ(elementary::sin(0.0), 0.0);
  EXPECT_EQ(elementary::cos(0.0), 1.0);
  EXPECT_EQ(elementary::tanh(0.0), 0.0);
  EXPECT_EQ(elementary::tanh(1000.0), 1.0);
  EXPECT_EQ(elementary::atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(elementary::atan2(0.0, -1.0), kPi);
  EXPECT_EQ(elementary::atan2(-0.0, -1.0), -kPi);
  EXPECT_EQ(elementary::atan2(1.0, 0.0), kPi / 2.0);
  EXPECT_EQ(elementary::hypot(0.0, 0.0), 0.0);
  EXPECT_EQ(elementary::hypot(3.0, 4.0), 5.0);
  EXPECT_DOUBLE_EQ(elementary::hypot(3e200, 4e200), 5e200);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(std::isnan(elementary::sin(bad)));
    EXPECT_TRUE(std::isnan(elementary::cos(bad)));
    EXPECT_TRUE(std::isnan(elementary::sincos(bad).sine));
    EXPECT_TRUE(std::isnan(elementary::sincos(bad).cosine));
  }
}

TEST(Elementary, HasTheSameBitsEverywhere) {
  EXPECT_EQ(bitsOf(20.0, [](Arguments& a, double bound) { return elementary::sin(a.next(bound)); }),
            0x42c2c032f160549cu);
  EXPECT_EQ(bitsOf(20.0, [](Arguments& a, double bound) { return elementary::cos(a.next(bound)); }),
            0xaa0c2e37fce590c0u);
  EXPECT_EQ(bitsOf(20.0, [](Arguments& a, double bound) { return elementary::sincos(a.next(bound)).sine; }),
            0x25b7b64cbfa9f680u);
  EXPECT_EQ(bitsOf(20.0, [](Arguments& a, double bound) { return elementary::sincos(a.next(bound)).cosine; }),
            0xceefaba7c6f889dcu);
  EXPECT_EQ(bitsOf(5.0, [](Arguments& a, double bound) { return elementary::tanh(a.next(bound)); }),
            0x48a5a2c3e473eb62u);
  const auto atan2 = [](Arguments& a, double bound) {
    const double y = a.next(bound);
    return elementary::atan2(y, a.next(bound));
  };
  EXPECT_EQ(bitsOf(3.0, atan2), 0x9fbf0196d6a9bbe7u);
  const auto hypot = [](Arguments& a, double bound) {
    const double x = a.next(bound);
    return elementary::hypot(x, a.next(bound));
  };
  EXPECT_EQ(bitsOf(3.0, hypot), 0xfcbe311ed60cfbc1u);
}

}  // namespace
}  // namespace baton
