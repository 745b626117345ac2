/// What the mathematics costs: the dynamics beside Orocos KDL and MuJoCo on the very same arms, and a step of each law.
///
///   deploy/baton bench laws
///   deploy/baton bench laws --benchmark_filter=mass      some cases only
///   deploy/baton bench laws --benchmark_out=FILE         every repetition, as JSON
///
/// It takes about a minute; the exit code is 1 when a ratio misses its target.
///
/// First the libraries' results are compared at the states that will be timed; if they differ, nothing is timed. Then
/// all cases are repeated in random order, so that whatever else the machine does falls on all of them alike. The table
/// shows medians of processor time in ns a call. Read the ratios: times depend on the machine and on its other work.
/// Baton's times are for the bits everybody gets, without instructions that only some processors have; Debian builds
/// the others the same way.
///
/// A column in terms of inverse dynamics shows what a law spends besides it. "Standing by" is a handover and a step, as
/// a law does at each step while another one holds the baton.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "bench/cases.hpp"
#include "bench/table.hpp"

int main(int argc, char** argv) {
  using namespace baton::bench;
  std::vector<std::string> arguments = {argv[0], "--benchmark_enable_random_interleaving=true",
                                        "--benchmark_repetitions=31", "--benchmark_min_time=0.02"};
  arguments.insert(arguments.end(), argv + 1, argv + argc);  // the last of two equal flags counts
  std::vector<char*> pointers(arguments.size());
  std::transform(arguments.begin(), arguments.end(), pointers.begin(), [](std::string& text) { return text.data(); });
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) return 2;

  try {
    addDynamics();
    addLaws();
    Table table;
    benchmark::RunSpecifiedBenchmarks(&table);
    return table.print(std::cout) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "baton-bench-laws: " << error.what() << "\n";
    return 1;
  }
}
