/// Noise as the report puts it on q_d: Gaussian, drawn anew at the start of each hold and constant until the next.
#pragma once

#include <cstdint>

#include "base/types.hpp"

namespace baton {

struct HoldNoise {
  double hold_s = 0.1;                  // length of a hold, positive
  JointVector standard_deviation = {};  // per joint, >= 0 [rad or m]
  std::uint64_t seed = 1;
};

/// The hold that a time falls into: floor(time_s / hold_s), where an instant within a millionth of the next hold
/// belongs to it, because a multiple of hold_s in binary may lie a hair below.
[[nodiscard]] std::int64_t holdIndex(const HoldNoise& noise, double time_s) noexcept;

/// A sample of the standard normal distribution, a pure function of its three numbers: samples can be asked for in any
/// order and again. Splitmix64 (Steele, Lea, Flood, OOPSLA 2014) turns them into bits, the polar method (Marsaglia and
/// Bray, SIAM Review 6, 1964) makes bits normal. Only + - * / and square roots are used, with a logarithm of its own
/// made of them: these IEEE 754 rounds alike everywhere, whereas the last digit of std::log is the C library's affair.
[[nodiscard]] double standardNormal(std::uint64_t seed, std::int64_t hold, int joint) noexcept;

}  // namespace baton
