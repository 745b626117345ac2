/// How late messages went out, in figures.
#pragma once

#include <span>

namespace baton {

struct Lateness {
  double p50_us = 0.0;
  double p99_us = 0.0;
  double max_us = 0.0;
};

/// Percentiles by nearest rank: the smallest value that at least that share of all values does not exceed. Zeros when
/// there are no values. Puts the values into another order, so that it needs no memory.
[[nodiscard]] Lateness latenessOf(std::span<double> values_us);

}  // namespace baton
