#include <Eigen/Cholesky>

#include "base/elementary.hpp"
#include "robot/dynamics.hpp"

namespace baton {

void frictionEffort(const RobotModel& model, const JointVector& qd, JointVector& tau_f) noexcept {
  tau_f.resize(model.size());
  for (int i = 0; i < model.size(); ++i) {
    const JointFriction& friction = model.joints[i].friction;
    tau_f(i) = friction.viscous * qd(i);
    if (friction.coulomb > 0.0) tau_f(i) += friction.coulomb * elementary::tanh(qd(i) / friction.coulomb_velocity);
  }
}

bool forwardDynamics(const RobotModel& model, const JointVector& q, const JointVector& qd, const JointVector& tau,
                     const Vector6& h_e, JointVector& qdd) noexcept {
  const int n = model.size();
  const JointVector no_acceleration = JointVector::Zero(n);
  JointVector bias, friction;
  inverseDynamics(model, q, qd, no_acceleration, h_e, bias);
  frictionEffort(model, qd, friction);

  JointMatrix B;
  massMatrix(model, q, B);
  const Eigen::LLT<Eigen::Ref<JointMatrix>> cholesky(B);  // in place
  if (cholesky.info() != Eigen::Success) return false;
  JointVector result = tau - bias - friction;
  cholesky.solveInPlace(result);
  if (!result.allFinite()) return false;
  qdd = result;
  return true;
}

}  // namespace baton
