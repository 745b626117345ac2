/// What is measured: each case is a run of the raw chain or of Baton, in one arrangement.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "programs.hpp"

namespace baton::bench {

struct Case {
  enum class Kind {
    kRaw,        // the yardstick
    kBaton,      // `baton run`
    kInProcess,  // `baton run --in-process`: no DDS, a lower bound of what a step takes
    kCells       // several runs at once
  };
  std::string name;  // for --only, and in the JSON
  Kind kind = Kind::kBaton;
  bool uses_force = true;      // the controller waits for the contact: 3 dependent hops a step, else 2
  bool shared_memory = false;  // instead of UDP
  bool recorded = false;       // with a recorder; raw: with a process that reads everything
  int standbys = 0;            // controllers that compute in shadow
  int cells = 1;

  [[nodiscard]] int hops() const { return uses_force ? 3 : 2; }
  [[nodiscard]] int processes() const;  // in the loop
};

/// In the order in which a round runs them: what is compared stands together.
[[nodiscard]] const std::vector<Case>& allCases();

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One run of a case.
struct Measurement {
  double p50_us = kUnknown;  // of the wall time between the openings of two steps; kCells: the median over the cells
  double p99_us = kUnknown;
  double steps_per_s = kUnknown;                   // kCells: of all together
  double startup_s = kUnknown;                     // from the launch of the first process to step 0
  std::map<std::string, double> resident_MB = {};  // by process
};

/// Runs a case once. Throws UnavailableError when it fails.
[[nodiscard]] Measurement measure(const Case& one, int steps, Programs& programs);

/// Whether this build of `baton` can run a scenario in one process.
[[nodiscard]] bool canRunInProcess(Programs& programs);

}  // namespace baton::bench
