/// Splitmix64 (Steele, Lea, Flood, OOPSLA 2014): splitmix(x), splitmix(x + kSplitmixStep)... is the generator.
/// Neighbouring numbers give unrelated ones.
#pragma once

#include <cstdint>

namespace baton {

inline constexpr std::uint64_t kSplitmixStep = 0x9e3779b97f4a7c15;

[[nodiscard]] constexpr std::uint64_t splitmix(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

}  // namespace baton
