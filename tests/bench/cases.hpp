/// What is timed. A case is named "arm/quantity/who", and table.hpp compares those who compute the same quantity.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "support/robots.hpp"

namespace baton::bench {

struct Arm {
  std::string name;
  RobotModel model;
};

/// The arms that everything is timed on.
[[nodiscard]] inline std::vector<Arm> arms() {
  return {{"RPP arm, 3 joints", test::rppRobot()}, {"revolute chain, 7 joints", test::randomRevoluteChain(7, 7)}};
}

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

/// The dynamics of each arm, by Baton, Orocos KDL and MuJoCo. Throws std::runtime_error when the libraries disagree.
void addDynamics();

/// One step of each registered law on each arm, with its default parameters, holding the baton and standing by. Laws on
/// the tip move its position alone, with more than three joints by the pseudo-inverse. Throws std::runtime_error when a
/// law refuses a step.
void addLaws();

}  // namespace baton::bench
