/// Cells that are paused before their first step, in one DDS domain, and a run beside them.
#pragma once

#include "programs.hpp"

namespace baton::bench {

struct RestCost {
  int processes = 0;              // of all the cells
  double started_s = 0.0;         // from the launch of the first cell until the last is paused
  double cpu_cores = 0.0;         // of all the cells together, at rest
  double beside_startup_s = 0.0;  // of a run in the same domain, from its launch to step 0
};

/// Throws UnavailableError when a cell does not start.
[[nodiscard]] RestCost measureRest(int cells, double seconds, Programs& programs);

}  // namespace baton::bench
