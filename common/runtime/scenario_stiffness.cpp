// Friction and walls that are too fast for the plant's steps and sub-steps: warned of at load, named when a motion is
// lost.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
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

/// Two half-spaces that face each other with a gap between them: the tip is in one of them at most.
bool isEitherOr(const PlaneSpec& a, const PlaneSpec& b) {
  constexpr double kRounding = 1e-9;
  const Vector3 n = a.normal.normalized();
  return a.unilateral && b.unilateral && (n + b.normal.normalized()).norm() < kRounding &&
         n.dot(a.point_m - b.point_m) >= 0.0;
}

/// Some of the scenario's walls, by their place in it.
using Walls = std::vector<std::size_t>;

/// What the tip may touch at one time: the first wall and those that can be touched with it.
Walls touchedWith(std::size_t first, const std::vector<PlaneSpec>& walls) {
  Walls touched{first};
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const auto excludes = [&](std::size_t other) { return isEitherOr(walls[other], walls[i]); };
    if (i != first && std::none_of(touched.begin(), touched.end(), excludes)) touched.push_back(i);
  }
  return touched;
}

StiffTerms wallTerms(const Scenario& scenario, const Walls& walls, const JointVector& joint_damping) {
  StiffTerms terms{.joint_damping = joint_damping};
  for (const std::size_t i : walls) {
    const PlaneSpec& plane = scenario.walls[i];
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

/// In motion friction is flat.
SubstepNeed needInMotion(const Scenario& scenario, const Walls& touched) {
  return needOf(scenario, wallTerms(scenario, touched, JointVector::Zero(scenario.robot.size())));
}

SubstepNeed shorter(const SubstepNeed& a, const SubstepNeed& b) { return b.longest_s < a.longest_s ? b : a; }

/// A cause that needs nearly all of what is needed by itself is to blame alone.
bool isToBlame(const SubstepNeed& cause, const SubstepNeed& all) {
  constexpr double kNearlyAll = 0.9;
  return kNearlyAll * cause.longest_s <= all.longest_s;
}

struct FastPole {
  SubstepNeed need;
  std::string cause;      // {:g} stands for the pole
  std::string otherwise;  // what to change instead of step and sub-steps
};

FastPole frictionPole(const Scenario& scenario) {
  JointVector slope(scenario.robot.size());
  for (int i = 0; i < slope.size(); ++i) {
    slope(i) = scenario.robot.joints[static_cast<std::size_t>(i)].friction.viscous;
  }
  const SubstepNeed viscous = needOf(scenario, {.joint_damping = slope});
  const SubstepNeed all = needOf(scenario, {.joint_damping = frictionSlope(scenario.robot)});
  if (isToBlame(viscous, all)) {
    return {all, "viscous joint friction makes a pole at {:g} 1/s", "less viscous friction in the robot file"};
  }
  const bool is_not_enough = viscous.substeps(scenario.stepSeconds()) > scenario.substeps;
  return {all, "joint friction makes a pole at {:g} 1/s near rest",
          std::string("a larger coulomb_velocity") + (is_not_enough ? " and less viscous friction" : "") +
              " in the robot file"};
}

/// Walls that are touched at one time, by that of them which needs the shortest sub-step alone.
FastPole wallPole(const Scenario& scenario, const Walls& touched, const std::vector<SubstepNeed>& alone) {
  const std::size_t stiffest = *std::min_element(touched.begin(), touched.end(), [&](std::size_t a, std::size_t b) {
    return alone[a].longest_s < alone[b].longest_s;
  });
  const SubstepNeed all = needInMotion(scenario, touched);
  const std::string name = fmt::format("wall {}", stiffest + 1);
  if (isToBlame(alone[stiffest], all)) {
    return {all, name + " makes a pole at {:g} 1/s where the tip touches it", "a softer wall"};
  }
  return {all, name + " and what is touched with it make a pole at {:g} 1/s", "softer walls"};
}

/// Sub-steps that would do or, where the step itself is too long or they would be too many, a shorter one with its own;
/// a whole part of the present one, so that every time of the scenario stays between two steps. Empty when nothing
/// would do.
std::string adviceFor(const SubstepNeed& held, const SubstepNeed& impact, const Scenario& scenario) {
  for (std::int64_t part = 1; scenario.step_ns / part >= kMinStep_ns; ++part) {
    if (scenario.step_ns % part != 0) continue;
    const double step_s = static_cast<double>(scenario.step_ns / part) / 1e9;
    const double substeps = held.substeps(step_s);
    if (impact.substeps(step_s) > 1.0 || substeps > kMaxSubsteps) continue;
    if (part == 1) return fmt::format("give substeps: {:.0f}", substeps);
    if (substeps <= scenario.substeps) return fmt::format("give step_s: {}", step_s);
    return fmt::format("give substeps: {:.0f} and step_s: {}", substeps, step_s);
  }
  return "";
}

}  // namespace

/// Looked at are the start and the joint waypoints, with the joints at rest, where friction is steepest, and with the
/// tip at each wall in turn, as if it were there. Not covered are all other places (on a path of the tip all but the
/// start), and a force that is kept over a step (coupling held or late), whose stability no sub-step changes.
/// Contact with what the tip can leave begins and ends between steps: the tip dives in freely for a part of a step and,
/// as it leaves, is held for a part of one. With a step that is longer than a sub-step has to be, impacts add energy.
void warnOfFastPoles(const YamlMap& map, Scenario& scenario) {
  FastPole held = frictionPole(scenario), impact;
  impact.need.longest_s = std::numeric_limits<double>::infinity();
  const std::size_t walls = scenario.coupling == Coupling::kDerivatives ? scenario.walls.size() : 0;
  std::vector<SubstepNeed> alone;
  for (std::size_t i = 0; i < walls; ++i) alone.push_back(needInMotion(scenario, {i}));
  for (std::size_t i = 0; i < walls; ++i) {
    Walls touched = touchedWith(i, scenario.walls);
    const FastPole wall = wallPole(scenario, touched, alone);
    const SubstepNeed at_rest = needOf(scenario, wallTerms(scenario, touched, frictionSlope(scenario.robot)));
    const SubstepNeed need = shorter(held.need, shorter(wall.need, at_rest));
    if (!isToBlame(held.need, need)) held = wall;
    held.need = need;
    if (!scenario.walls[i].unilateral) continue;
    const auto stays = [&](std::size_t other) { return !scenario.walls[other].unilateral; };
    const std::size_t all = touched.size();
    touched.erase(std::remove_if(touched.begin(), touched.end(), stays), touched.end());
    const FastPole left = touched.size() == all ? wall : wallPole(scenario, touched, alone);
    if (left.need.longest_s < impact.need.longest_s) impact = left;
  }
  const double step_s = scenario.stepSeconds();
  const bool is_impact = impact.need.substeps(step_s) > 1.0;
  if (!is_impact && held.need.substeps(step_s) <= scenario.substeps) return;
  const FastPole& worst = is_impact ? impact : held;
  const std::string advice = adviceFor(held.need, impact.need, scenario);
  scenario.fast_pole = fmt::format(fmt::runtime(worst.cause), worst.need.pole_per_s) + ", too fast for " +
                       (is_impact ? "contact that begins and ends between steps" : "the plant's sub-steps") + "; " +
                       (advice.empty() ? "no step and sub-steps that a scenario may have would do" : advice);
  scenario.warnings.push_back(map["step_s"].place() + scenario.fast_pole + (advice.empty() ? ": give " : ", or ") +
                              worst.otherwise);
}

std::string Scenario::lostMotion(const Contact& contact, bool is_its_doing) const {
  const std::string lost = "the motion has run away: ";
  const bool is_touching = contact.penetration > 0.0;
  if (is_its_doing && !is_touching) {
    return lost + fmt::format("the contact that the environment sent pushes with {:g} N, where the tip touches nothing",
                              contact.h_e.head<3>().norm());
  }
  if (!fast_pole.empty()) return lost + fast_pole;
  if (!is_touching) return lost + "the step may be too long for the law's gains";
  if (coupling != Coupling::kDerivatives) {
    return lost +
           "the step may be too long for the wall's force, which the coupling keeps over it, or for the law's gains";
  }
  return lost + "the step or its sub-steps may be too long for the law's gains or for the wall's stiffness" +
         (is_its_doing ? fmt::format("; it is pushed by {:g} N of contact", contact.h_e.head<3>().norm()) : "");
}

}  // namespace baton
