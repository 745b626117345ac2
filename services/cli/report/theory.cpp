#include "theory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "control/nearest_name.hpp"
#include "robot/kinematics.hpp"
#include "theory_tools.hpp"
#include "trajectory/trajectory.hpp"

namespace baton {
namespace {

struct CheckEntry {
  const char* name;
  theory::Checks (*check)(const theory::Inputs&);
  bool compares = false;  // needs a second run
};

constexpr CheckEntry kChecks[] = {
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
    {"settling", theory::settling},
    {"tracks", theory::tracks},
    {"adaptation_effect", theory::adaptationEffect, true},
    {"adaptation_learns", theory::adaptationLearns},
    {"task_goal", theory::taskGoal},
    {"no_contact", theory::noContact},
    {"angle_jump", theory::angleJump},
    {"spurious_equilibrium", theory::spuriousEquilibrium},
    {"task_balance", theory::taskBalance},
    {"compliance_force", theory::complianceForce},
    {"impedance_balance", theory::impedanceBalance},
    {"printed_impedance_balance", theory::printedImpedanceBalance},
    {"unforced_impedance_balance", theory::unforcedImpedanceBalance},
    {"admittance_balance", theory::admittanceBalance},
    {"force_goal", theory::forceGoal},
    {"force_drift", theory::forceDrift},
    {"parallel_goal", theory::parallelGoal},
    {"same_bytes_in_one_process", theory::sameBytesInOneProcess},
    {"coupling_growth", theory::couplingGrowth},
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
  for (const CheckEntry& entry : kChecks) names.emplace_back(entry.name);
  return names;
}

std::vector<Check> runCheck(const CheckRequest& request, const std::vector<Trace>& runs) {
  const auto* const entry = std::find_if(std::begin(kChecks), std::end(kChecks),
                                         [&](const CheckEntry& one) { return request.name == one.name; });
  if (entry == std::end(kChecks)) throw UsageError(unknownName("check", request.name, checkNames()));
  if (entry->compares != request.other.has_value()) {
    throw UsageError("check " + request.name + ": expected " +
                     (entry->compares ? "another run to compare with" : "one run alone") + ", found " +
                     (entry->compares ? "none" : "two"));
  }
  const theory::Inputs inputs{.run = runCalled(request.name, request.run, runs),
                              .other = request.other ? &runCalled(request.name, *request.other, runs) : nullptr};
  return entry->check(inputs);
}

Check followsScenario(const Trace& run) {
  const RobotModel& robot = run.scenario.robot;
  const Trajectory trajectory(robot, run.scenario.trajectory);
  theory::Largest worst;
  const auto compare = [&](const auto& wanted, const auto& recorded) {
    worst.add((wanted - recorded).cwiseAbs().template maxCoeff<Eigen::PropagateNaN>());
  };
  Reference wanted;
  msg::Reference sent;  // an orientation is a quaternion there
  for (Eigen::Index k = 0; k < run.steps(); ++k) {
    trajectory.evaluate(run.time(k), wanted);
    toMessage({}, wanted, sent);
    if (!fromMessage(sent, robot.size(), wanted)) worst.add(std::nan(""));
    if (wanted.q.size() > 0) {
      compare(wanted.q, run.q_d.col(k));
      compare(wanted.qd, run.qd_d.col(k));
      compare(wanted.qdd, run.qdd_d.col(k));
    }
    if (wanted.has_task) {
      compare(wanted.X_WE.p, run.p_WE_d.col(k));
      compare(zyzFromRotation(wanted.X_WE.R), run.zyz_d.col(k));
      compare(wanted.V_WE, run.V_WE_d.col(k));
      compare(wanted.A_WE, run.A_WE_d.col(k));
      compare(wanted.h_d, run.h_d.col(k));
    }
  }
  return {.what = "largest difference between the recorded reference and the scenario's",
          .unit = "rad, m, or their rates",
          .predicted = 0.0,
          .measured = worst,
          .tolerance = 0.0};
}

}  // namespace baton
