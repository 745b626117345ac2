/// What is timed. A case is named "arm/quantity/who", and table.hpp compares those who compute the same quantity.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

namespace baton::bench {

inline constexpr const char* kRppArm = "RPP arm, 3 joints";
inline constexpr int kStates = 64;  // visited in turn, so that no call repeats the one before
static_assert((kStates & (kStates - 1)) == 0);

/// Registers call(k), k = 0, 1, ... kStates - 1 and round again.
template <typename Call>
void addCase(const std::string& name, Call call) {
  benchmark::RegisterBenchmark(name.c_str(), [call](benchmark::State& state) mutable {
    int k = 0;
    for ([[maybe_unused]] auto _ : state) {
      auto result = call(k);
      benchmark::DoNotOptimize(result);
      benchmark::ClobberMemory();
      k = (k + 1) & (kStates - 1);
    }
  });
}

/// The dynamics of chains of 3 and 7 joints, by Baton, Orocos KDL and MuJoCo. Throws std::runtime_error when the
/// libraries disagree.
void addDynamics();

/// One step of each registered law on the RPP arm, holding the baton and standing by. Throws std::runtime_error when a
/// law refuses a step.
void addLaws();

}  // namespace baton::bench
