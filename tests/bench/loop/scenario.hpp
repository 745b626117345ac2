/// The scenario of the bench: an arm that moves towards a wall and presses on it, under one law with others standing
/// by.
#pragma once

#include <cstdint>
#include <string>

namespace baton::bench {

inline constexpr std::int64_t kStep_ns = 500'000;

/// @param uses_force  impedance control, which waits for the contact of the step; else operational-space inverse
///                    dynamics, which does not.
/// @param standbys    0 to 6 controllers more, of different laws.
/// @param rate        simulated seconds per second, 0 for as fast as possible.
[[nodiscard]] std::string scenarioText(bool uses_force, int standbys, int steps, double rate = 0.0);

}  // namespace baton::bench
