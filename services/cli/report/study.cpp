#include "study.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "control/nearest_name.hpp"
#include "coupling_charts.hpp"

namespace baton {
namespace {

struct ChartEntry {
  const char* name;
  ChartResult (*make)(const study::Inputs&);
};

constexpr ChartEntry kCharts[] = {
    {"coupling_energy", study::couplingEnergy},
    {"coupling_stability", study::couplingStability},
    {"coupling_error", study::couplingError},
};

}  // namespace

std::vector<std::string> chartNames() {
  std::vector<std::string> names;
  for (const ChartEntry& entry : kCharts) names.emplace_back(entry.name);
  return names;
}

ChartResult makeChart(const ChartRequest& request, const std::vector<Trace>& runs, const ShowProgress& progress) {
  const auto* const entry = std::find_if(std::begin(kCharts), std::end(kCharts),
                                         [&](const ChartEntry& one) { return request.name == one.name; });
  if (entry == std::end(kCharts)) throw UsageError(unknownName("chart", request.name, chartNames()));
  return entry->make({.runs = runs, .base = runs.at(static_cast<std::size_t>(request.run)), .progress = progress});
}

}  // namespace baton
