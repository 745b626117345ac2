// Friction and walls that are too fast for the plant's sub-steps: warned of at load, named when a motion is lost.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>
#include <variant>

#include "robot/substeps.hpp"
#include "runtime/scenario_parts.hpp"

namespace baton {
namespace {

/// Where the poles are looked at.
std::vector<JointVector> configurationsOf(const Scenario& scenario) {
  std::vector<JointVector> configurations{scenario.start_q};
  if (const auto* path = std::get_if<JointPath>(&scenario.trajectory.motion)) {
    for (const JointPath::Waypoint& waypoint : path->waypoints) configurations.push_back(waypoint.q);
  }
  return configurations;
}

/// What the tip may touch at one time: the planes that hold it from both sides, and one that it can leave.
StiffTerms wallTerms(const Scenario& scenario, std::size_t touched) {
  StiffTerms terms{.joint_damping = JointVector::Zero(scenario.robot.size())};
  for (std::size_t i = 0; i < scenario.walls.size(); ++i) {
    const PlaneSpec& plane = scenario.walls[i];
    if (plane.unilateral && i != touched) continue;
    const Vector3 n = plane.normal.normalized();
    terms.tip_stiffness += plane.stiffness_N_per_m * n * n.transpose();
    terms.tip_damping += plane.damping_N_s_per_m * n * n.transpose();
  }
  return terms;
}

/// The need of that of the configurations which has the fastest pole.
SubstepNeed needOf(const Scenario& scenario, const StiffTerms& terms) {
  std::optional<SubstepNeed> worst;
  for (const JointVector& q : configurationsOf(scenario)) {
    const SubstepNeed need = substepNeed(scenario.robot, q, terms);
    if (!worst || need.longest_s < worst->longest_s) worst = need;
  }
  return *worst;
}

SubstepNeed shorter(const SubstepNeed& a, const SubstepNeed& b) { return b.longest_s < a.longest_s ? b : a; }

/// Sub-steps that would do or, where there may not be so many, a shorter step with its own; a whole part of the present
/// one, so that every time of the scenario stays between two steps. Empty when nothing would do.
std::string adviceFor(const SubstepNeed& need, std::int64_t step_ns) {
  for (std::int64_t part = 1; step_ns / part >= kMinStep_ns; ++part) {
    if (step_ns % part != 0) continue;
    const std::int64_t shorter_ns = step_ns / part;
    const double step_s = static_cast<double>(shorter_ns) / 1e9;
    const double substeps = need.substeps(step_s);
    if (substeps > kMaxSubsteps) continue;
    const std::string text = fmt::format("give substeps: {:.0f}", substeps);
    return part == 1 ? text : fmt::format("{} and step_s: {}", text, step_s);
  }
  return "";
}

}  // namespace

/// Looked at are the start and the joint waypoints, with the joints at rest, where friction is steepest, and with the
/// tip at each wall in turn, as if it were there. Not covered are all other places (on a path of the tip
/// all but the start), corners in which several walls are touched, and a force that is kept over a step (coupling held
/// or late), whose stability no sub-step changes.
void warnOfFastPoles(const YamlMap& map, Scenario& scenario) {
  const JointVector friction = frictionSlope(scenario.robot);
  StiffTerms terms{.joint_damping = friction};
  SubstepNeed need = needOf(scenario, terms);
  const double friction_s = need.longest_s;
  std::string cause = "joint friction makes a pole at {:g} 1/s near rest";
  const bool is_coulomb = std::any_of(scenario.robot.joints.begin(), scenario.robot.joints.end(),
                                      [](const Joint& joint) { return joint.friction.coulomb > 0.0; });
  std::string otherwise =
      is_coulomb ? "a larger coulomb_velocity in the robot file" : "less friction in the robot file";
  for (std::size_t i = 0; i < scenario.walls.size() && scenario.coupling == Coupling::kDerivatives; ++i) {
    terms = wallTerms(scenario, i);
    SubstepNeed wall = needOf(scenario, terms);  // in motion friction is flat
    terms.joint_damping = friction;
    wall = shorter(wall, needOf(scenario, terms));
    // Where both are there, friction is to blame for what it needs alone.
    constexpr double kAsMuch = 0.9;
    const bool is_to_blame = wall.longest_s < kAsMuch * std::min(need.longest_s, friction_s);
    need = shorter(need, wall);
    if (!is_to_blame) continue;
    cause = fmt::format("wall {} makes a pole at {{:g}} 1/s where the tip touches it", i + 1);
    otherwise = "a softer wall";
  }
  if (!(need.substeps(scenario.stepSeconds()) > scenario.substeps)) return;
  const std::string advice = adviceFor(need, scenario.step_ns);
  scenario.fast_pole = fmt::format(fmt::runtime(cause), need.pole_per_s) + ", too fast for the plant's sub-steps; " +
                       (advice.empty() ? "no step and sub-steps that a scenario may have would do" : advice);
  scenario.warnings.push_back(map["step_s"].place() + scenario.fast_pole + (advice.empty() ? ": give " : ", or ") +
                              otherwise);
}

std::string Scenario::lostMotion(bool is_touching) const {
  const std::string lost = "the motion is no longer finite: ";
  if (!fast_pole.empty()) return lost + fast_pole;
  if (!is_touching) return lost + "the step may be too long for the law's gains";
  if (coupling != Coupling::kDerivatives) {
    return lost +
           "the step may be too long for the wall's force, which the coupling keeps over it, or for the law's gains";
  }
  return lost + "the step or its sub-steps may be too long for the law's gains or for the wall's stiffness";
}

}  // namespace baton
