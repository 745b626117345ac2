/// Checks of plant and wall as processes of their own: the distributed run against one process, byte for byte, and the
/// damping that a coupling rule amounts to.
#include <cmath>

#include "runtime/monolithic_run.hpp"
#include "sprung_mass.hpp"
#include "theory_tools.hpp"

namespace baton::theory {

// The chain of hashes covers every payload of the loop: state, contact, command and, through the command, the
// reference.
Checks sameBytesInOneProcess(const Inputs& in) {
  MonolithicRun run(in.run.scenario);
  const auto steps = static_cast<double>(in.run.scenario.end_step + 1);
  std::size_t same = 0;
  for (const std::uint64_t recorded : in.run.chain) {
    same += recorded == run.chainHash() ? 1 : 0;
    run.step();
  }
  return {
      within("steps whose bytes are those of the same run in one process", "", steps, static_cast<double>(same), 0.0)};
}

// The amplitude is multiplied by |lambda| a step, lambda the largest eigenvalue of the map of one step. As damping d of
// m x'' + d x' + K x = 0, whose amplitude grows at -d / (2 m), that is -K dt/2 (held) and -3 K dt/2 (late) to first
// order; the next term is a part of it, z/4 (held) and 19 z/12 (late) with z = (omega dt)^2. With derivatives RK4's own
// loss is left, (omega h)^6 / 144 a sub-step of h.
Checks couplingGrowth(const Inputs& in) {
  const Scenario& scenario = in.run.scenario;
  const SprungMass mass = sprungMassOf(scenario);
  const double dt_s = scenario.stepSeconds(), omega = std::sqrt(mass.K / mass.m);
  Eigen::VectorXd depth(in.run.steps());
  for (Eigen::Index k = 0; k < depth.size(); ++k) depth(k) = depthOf(scenario, in.run.p_WE.col(k));

  const double map_rate = std::log(spectralRadius(stepMap(mass, scenario.coupling, dt_s, scenario.substeps))) / dt_s;
  const double rate = measuredGrowth(depth, dt_s);
  constexpr double kRounding = 1e-9;  // 1/s: positions are good for 1e-16 m of 10 mm, over seconds
  Checks checks{within("growth of the amplitude", "1/s", map_rate, rate, kRounding + 1e-6 * std::abs(map_rate))};

  const double damping = couplingDamping(mass, scenario.coupling, dt_s);
  const double beyond = 2.0 * std::abs(damping) * std::pow(omega * dt_s, 2);
  const double h = dt_s / scenario.substeps;
  const double integrator = 2.0 * mass.m * std::pow(omega * h, 6) / (144.0 * h);
  checks.push_back(within("damping that the coupling amounts to", "N s/m", damping, -2.0 * mass.m * rate,
                          beyond + 2.0 * integrator + 2.0 * mass.m * kRounding));
  return checks;
}

}  // namespace baton::theory
