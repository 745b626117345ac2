#include "trajectory/hold_noise.hpp"

#include <cmath>

#include "base/splitmix64.hpp"

namespace baton {
namespace {

/// The upper 53 bits as a number in [-1, 1).
double signedUnit(std::uint64_t bits) noexcept { return static_cast<double>(bits >> 11) * 0x1p-52 - 1.0; }

/// ln x for x > 0, by ln(m 2^e) = e ln 2 + 2 artanh((m - 1) / (m + 1)) with m in [sqrt(1/2), sqrt(2)): the series then
/// loses a factor of 34 a term, so eleven terms are enough for a double.
double naturalLogarithm(double x) noexcept {
  constexpr double kLn2 = 0.693147180559945309417, kSqrtHalf = 0.707106781186547524401;
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // in [1/2, 1)
  if (m < kSqrtHalf) {
    m *= 2.0;
    --exponent;
  }
  const double r = (m - 1.0) / (m + 1.0);
  double series = 0.0;
  for (int k = 21; k >= 1; k -= 2) series = series * (r * r) + 1.0 / k;
  return exponent * kLn2 + 2.0 * r * series;
}

}  // namespace

std::int64_t holdIndex(const HoldNoise& noise, double time_s) noexcept {
  constexpr double kHair = 1e-6;
  return static_cast<std::int64_t>(std::floor(time_s / noise.hold_s + kHair));
}

double standardNormal(std::uint64_t seed, std::int64_t hold, int joint) noexcept {
  // One number scrambled into the next: neighbours in any of the three have unrelated streams.
  std::uint64_t stream = splitmix(seed + kSplitmixStep);
  stream = splitmix(stream + static_cast<std::uint64_t>(hold) * kSplitmixStep);
  stream = splitmix(stream + static_cast<std::uint64_t>(joint) * kSplitmixStep);
  while (true) {  // a point in the square falls into the circle with probability pi / 4
    const double x = signedUnit(splitmix(stream += kSplitmixStep));
    const double y = signedUnit(splitmix(stream += kSplitmixStep));
    const double square = x * x + y * y;
    if (square > 0.0 && square < 1.0) return x * std::sqrt(-2.0 * naturalLogarithm(square) / square);
  }
}

}  // namespace baton
