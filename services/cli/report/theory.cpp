#include "theory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "control/nearest_name.hpp"
#include "theory_tools.hpp"

namespace baton {
namespace {

struct Entry {
  const char* name;
  theory::Checks (*check)(const theory::Inputs&);
  bool compares = false;  // needs a second run
};

constexpr Entry kChecks[] = {
    {"reaches_goal", theory::reachesGoal},
    {"decay_rate", theory::decayRate},
    {"gravity_offset", theory::gravityOffset},
    {"noise_response", theory::noiseResponse, true},
    {"second_order_error", theory::secondOrderError},
    {"mass_scale_offset", theory::massScaleOffset},
    {"settles_after_motion", theory::settlesAfterMotion},
    {"bias_offset", theory::biasOffset},
    {"uncompensated_offset", theory::uncompensatedOffset, true},
    {"first_torque", theory::firstTorque},
    {"saturated_settles", theory::saturatedSettles},
    {"tracks", theory::tracks},
    {"adaptation_is_inert", theory::adaptationIsInert, true},
    {"adaptation_learns", theory::adaptationLearns},
    {"task_goal", theory::taskGoal},
    {"angle_jump", theory::angleJump},
    {"spurious_equilibrium", theory::spuriousEquilibrium},
    {"task_balance", theory::taskBalance},
    {"impedance_balance", theory::impedanceBalance},
    {"printed_impedance_balance", theory::printedImpedanceBalance},
    {"unforced_impedance_balance", theory::unforcedImpedanceBalance},
    {"admittance_balance", theory::admittanceBalance},
    {"force_goal", theory::forceGoal},
    {"force_drift", theory::forceDrift},
    {"parallel_goal", theory::parallelGoal},
};

const Trace& runCalled(const std::string& check, int index, const std::vector<Trace>& runs) {
  if (index < 0 || index >= static_cast<int>(runs.size())) {
    throw UsageError("check " + check + ": expected a run from 0 to " +
                     std::to_string(static_cast<int>(runs.size()) - 1) + ", found " + std::to_string(index));
  }
  const Trace& run = runs[static_cast<std::size_t>(index)];
  if (run.steps() < 3)
    throw UsageError("check " + check + ": expected a run of some steps, found " + std::to_string(run.steps()));
  return run;
}

}  // namespace

bool Check::passes() const {
  return std::abs(measured - predicted) <= (is_relative ? tolerance * std::abs(predicted) : tolerance);
}

std::vector<std::string> checkNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kChecks) names.emplace_back(entry.name);
  return names;
}

std::vector<Check> runCheck(const CheckRequest& request, const std::vector<Trace>& runs) {
  const auto* const entry =
      std::find_if(std::begin(kChecks), std::end(kChecks), [&](const Entry& one) { return request.name == one.name; });
  if (entry == std::end(kChecks)) throw UsageError(unknownName("check", request.name, checkNames()));
  if (entry->compares != request.other.has_value()) {
    throw UsageError("check " + request.name + ": expected " +
                     (entry->compares ? "another run to compare with" : "one run alone") + ", found " +
                     (entry->compares ? "none" : "two"));
  }
  const theory::Inputs inputs{.run = runCalled(request.name, request.run, runs),
                              .other = request.other ? &runCalled(request.name, *request.other, runs) : nullptr};
  std::vector<Check> checks = entry->check(inputs);
  if (request.tolerance) {
    for (Check& check : checks) check.tolerance = *request.tolerance;
  }
  return checks;
}

}  // namespace baton
