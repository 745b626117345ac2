/// A mass on a spring wall as each coupling rule makes the plant see it: m x'' = -K x - D v_k. K is the wall's, D acts
/// through a torque held over the step, v_k the velocity at its start. The wall's force is followed (derivatives), kept
/// from the step's start (held) or from the one before (late). All of it is linear, so theory is exact.
#pragma once

#include <Eigen/Core>

#include "base/types.hpp"
#include "runtime/scenario.hpp"

namespace baton::theory {

struct SprungMass {
  double m = 0.0;  // kg
  double K = 0.0;  // N/m
  double D = 0.0;  // N s/m
};

/// The tip of a scenario's arm along the normal of its one spring wall, moved by one joint alone under joint_pd without
/// stiffness. Throws UsageError when the scenario is something else.
[[nodiscard]] SprungMass sprungMassOf(const Scenario& scenario);

/// Speed of the tip along the normal of the scenario's first wall, at the start, by joint velocity: depth' = along .
/// qd.
[[nodiscard]] JointVector alongNormal(const Scenario& scenario);

/// Depth of the tip in the scenario's first wall, along its normal [m].
[[nodiscard]] double depthOf(const Scenario& scenario, const Vector3& p_WE);

/// One step: [x, v, x a step before] to the same one step later, with RK4 in `substeps` as the plant integrates.
[[nodiscard]] Matrix3 stepMap(const SprungMass& mass, Coupling coupling, double dt_s, int substeps);

/// Largest modulus of the map's eigenvalues: what the amplitude is multiplied by each step, in the end.
[[nodiscard]] double spectralRadius(const Matrix3& map);

/// The damping that the rule amounts to, to first order in dt: 0, -K dt/2, -3 K dt/2 [N s/m].
[[nodiscard]] double couplingDamping(const SprungMass& mass, Coupling coupling, double dt_s);

/// Up to which step the motion dies out, by Jury's criterion on the map of exact integration, its eigenvalues inside
/// the unit circle [s]. With b = D dt/m, z = K dt^2/m, omega = sqrt(K/m):
///   held         D > K dt/2
///   late         b > z (6 + z) / (2 (2 + z)), which is D > 3 K dt/2 to first order
///   derivatives  D / (m omega) < cot(omega dt/2)
/// and b < 2, beyond which the held damping itself overshoots; the last condition contains it.
[[nodiscard]] double stableStep(const SprungMass& mass, Coupling coupling);

/// Rate at which the amplitude of a measured motion grows, from its positions step by step [1/s]. Two modes of a linear
/// recurrence make x(k) x(k + 2) - x(k + 1)^2 grow by exactly the product of their multipliers; a third one must have
/// died out, which is given a few steps at the start.
[[nodiscard]] double measuredGrowth(const Eigen::VectorXd& x, double dt_s);

}  // namespace baton::theory
