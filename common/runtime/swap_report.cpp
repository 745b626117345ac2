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

nlohmann::ordered_json toJson(const msg::SwapOutcome& swap) {
  return {{"done", swap.done()},
          {"outgoing", swap.outgoing().c_str()},
          {"incoming", swap.incoming().c_str()},
          {"request_id", swap.request_id()},
          {"plan_id", swap.plan_id()},
          {"decided_at_step", swap.decided_at_step()},
          {"at_step", swap.at_step()},
          {"hard", swap.hard()},
          {"blend_steps", swap.blend_steps()},
          {"raw_effort_step", swap.raw_effort_step()},
          {"applied_effort_step", swap.applied_effort_step()},
          {"reason", swap.reason().c_str()}};
}

}  // namespace baton
