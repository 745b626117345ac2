/// What the benches make of measured values.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace baton::bench {

/// Of the values that were measured, which NaN was not; NaN when there is none.
[[nodiscard]] inline double median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return 0.5 * (values[values.size() / 2] + values[(values.size() - 1) / 2]);
}

/// The smallest value that a part of all does not exceed (nearest rank).
/// @param sorted  rising, not empty.
template <class T>
[[nodiscard]] T quantile(const std::vector<T>& sorted, double part) {
  const double rank = std::ceil(part * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace baton::bench
