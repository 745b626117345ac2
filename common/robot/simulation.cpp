#include "robot/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

/// The contact wrench as the tip moves away from where it was at the start of the step.
class FollowedContact {
 public:
  FollowedContact(const RobotModel& model, const Contact& contact, const JointVector& q, const JointVector& qd) noexcept
      : model_(model), contact_(contact), follows_(!contact.df_dp.isZero(0.0) || !contact.df_dv.isZero(0.0)) {
    if (!follows_) return;
    computeKinematics(model_, q, qd, kinematics_);
    p0_ = kinematics_.X_WE.p;
    v0_ = kinematics_.V_WE.head<3>();
  }

  [[nodiscard]] Vector6 at(const JointVector& q, const JointVector& qd) noexcept {
    Vector6 h_e = contact_.h_e;
    if (!follows_) return h_e;
    computeKinematics(model_, q, qd, kinematics_);
    h_e.head<3>() += contact_.df_dp * (kinematics_.X_WE.p - p0_);
    h_e.head<3>() += contact_.df_dv * (kinematics_.V_WE.head<3>() - v0_);
    return h_e;
  }

 private:
  const RobotModel& model_;
  const Contact& contact_;
  const bool follows_;
  Kinematics kinematics_;
  Vector3 p0_ = Vector3::Zero();
  Vector3 v0_ = Vector3::Zero();
};

}  // namespace

int saturateEffort(const RobotModel& model, JointVector& tau) noexcept {
  int cut = 0;
  for (int i = 0; i < model.size(); ++i) {
    const double limit = model.joints[i].effort_limit;
    if (std::abs(tau(i)) > limit) {
      tau(i) = std::copysign(limit, tau(i));
      ++cut;
    }
  }
  return cut;
}

bool integrateStep(const RobotModel& model, const JointVector& tau, const Contact& contact, double dt_s, int substeps,
                   JointVector& q, JointVector& qd) noexcept {
  assert(substeps > 0);
  FollowedContact followed(model, contact, q, qd);
  const auto acceleration = [&](const JointVector& position, const JointVector& velocity, JointVector& result) {
    return forwardDynamics(model, position, velocity, tau, followed.at(position, velocity), result);
  };

  const double h = dt_s / substeps;
  JointVector q1 = q, v1 = qd;  // state at the start of the sub-step; 2, 3, 4: the later stages
  JointVector q2, v2, q3, v3, q4, v4, a1, a2, a3, a4;
  for (int k = 0; k < substeps; ++k) {
    if (!acceleration(q1, v1, a1)) return false;
    q2 = q1 + 0.5 * h * v1;
    v2 = v1 + 0.5 * h * a1;
    if (!acceleration(q2, v2, a2)) return false;
    q3 = q1 + 0.5 * h * v2;
    v3 = v1 + 0.5 * h * a2;
    if (!acceleration(q3, v3, a3)) return false;
    q4 = q1 + h * v3;
    v4 = v1 + h * a3;
    if (!acceleration(q4, v4, a4)) return false;
    q1 += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    v1 += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  if (!isInRange(q1) || !(v1.array().abs() <= kFastestMotion).all()) return false;
  q = q1;
  qd = v1;
  return true;
}

}  // namespace baton
