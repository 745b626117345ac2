#include "lateness.hpp"

#include <algorithm>
#include <cstddef>

namespace baton {

Lateness latenessOf(std::span<double> values_us) {
  if (values_us.empty()) return {};
  const auto at_percent = [&](std::size_t percent) {
    const std::size_t rank = (values_us.size() * percent + 99) / 100;
    return values_us.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  };
  const auto p50 = at_percent(50);
  const auto p99 = at_percent(99);
  std::nth_element(values_us.begin(), p99, values_us.end());
  std::nth_element(values_us.begin(), p50, p99);
  return {.p50_us = *p50, .p99_us = *p99, .max_us = *std::max_element(p99, values_us.end())};
}

}  // namespace baton
