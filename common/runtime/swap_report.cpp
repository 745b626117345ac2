#include "runtime/swap_report.hpp"

namespace baton {

nlohmann::ordered_json toJson(const msg::SwapReport& report) {
  return {{"steps", report.steps()},
          {"cut_short", report.cut_short()},
          {"max_effort_rate", report.max_effort_rate()},
          {"rate_limit_hits", report.rate_limit_hits()},
          {"peak_force_deviation_N", report.peak_force_deviation()},
          {"blend_energy_J", report.blend_energy()}};
}

}  // namespace baton
