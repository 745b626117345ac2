/// Several cells at once: robots with all their processes, side by side on one machine and in one DDS domain.
#pragma once

#include "cases.hpp"

namespace baton::bench {

/// Starts the cells at a crawl and lets them go as fast as they can when the last of them runs, so that what is
/// measured is all of them together.
[[nodiscard]] Measurement measureCells(const Case& one, int steps, Programs& programs);

}  // namespace baton::bench
