/// B(q) qdd + C(q, qd) qd + g(q) + friction(qd) = tau - J^T h_e,   h_e the wrench the tip exerts on the environment.
/// Two independent roads to the same equation, tested against each other: the fast recursive one (Newton-Euler,
/// composite bodies) that laws and the plant use, and Lagrange's (partial Jacobians, Christoffel symbols) that gives C
/// itself. Everything is noexcept and allocates nothing; vectors have n entries, matrices n x n.
#pragma once

#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// tau = B qdd + C qd + g + J^T h_e by recursive Newton-Euler (Siciliano et al. 2009, sec. 7.5), without friction.
/// @param h_e  wrench the tip exerts on the environment, in W at the tip.
void inverseDynamics(const RobotModel& model, const JointVector& q, const JointVector& qd, const JointVector& qdd,
                     const Vector6& h_e, JointVector& tau) noexcept;

/// n = C qd + g.
void biasEffort(const RobotModel& model, const JointVector& q, const JointVector& qd, JointVector& n) noexcept;

/// g(q).
void gravityEffort(const RobotModel& model, const JointVector& q, JointVector& g) noexcept;

/// B(q) by composite rigid bodies, symmetric positive definite.
void massMatrix(const RobotModel& model, const JointVector& q, JointMatrix& B) noexcept;

/// Friction effort, opposing motion: viscous and regularised Coulomb.
void frictionEffort(const RobotModel& model, const JointVector& qd, JointVector& tau_f) noexcept;

/// qdd from tau, with friction and contact: B qdd = tau - J^T h_e - n - friction.
/// Returns false, leaving qdd as it was, when B cannot be factorised or the result is not finite.
[[nodiscard]] bool forwardDynamics(const RobotModel& model, const JointVector& q, const JointVector& qd,
                                   const JointVector& tau, const Vector6& h_e, JointVector& qdd) noexcept;

/// Lagrange's road (sec. 7.1 and 7.2): partial Jacobians of the centres of mass; C from Christoffel symbols of the
/// first kind, so dB/dt - 2C is skew-symmetric.
struct LagrangeTerms {
  JointMatrix B;
  JointMatrix C;
  JointVector g;
};
void lagrangeDynamics(const RobotModel& model, const JointVector& q, const JointVector& qd,
                      LagrangeTerms& out) noexcept;

/// Kinetic energy [J] and potential energy [J] (zero at the world's origin).
[[nodiscard]] double kineticEnergy(const RobotModel& model, const JointVector& q, const JointVector& qd) noexcept;
[[nodiscard]] double potentialEnergy(const RobotModel& model, const JointVector& q) noexcept;

}  // namespace baton
