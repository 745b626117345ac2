/// What our own studies compute: a recorded run taken as a starting point, varied and run again in this process, many
/// times over. Each gives a chart and checks of its numbers against theory.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "chart.hpp"
#include "theory.hpp"

namespace baton {

struct ChartRequest {
  std::string name;  // out of chartNames()
  int run = 0;       // index into the figure's runs
};

struct ChartResult {
  Chart chart;
  std::vector<Check> checks;
};

/// Called now and then with the part that is done, 0 to 1.
using ShowProgress = std::function<void(double)>;

[[nodiscard]] std::vector<std::string> chartNames();

/// Throws UsageError for a name that is not known, a run that is not there, or one to which the chart does not apply.
[[nodiscard]] ChartResult makeChart(const ChartRequest& request, const std::vector<Trace>& runs,
                                    const ShowProgress& progress);

}  // namespace baton
