/// A law and an arm in one loop, as the plant would run them but without messages: the bench on which tests compare
/// what a law does with what its equation says.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <utility>

#include "control/law.hpp"
#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "robot/simulation.hpp"
#include "support/robots.hpp"

namespace baton::test {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kWallHeight = 0.7;  // of the report's wall, normal to z [m]

/// The report's wall, touched from below; no wall when Ke is zero.
[[nodiscard]] inline Contact wallContact(double Ke_N_per_m, const Vector3& p_WE) {
  Contact contact;
  contact.penetration = std::max(0.0, p_WE.z() - kWallHeight);
  contact.h_e.z() = Ke_N_per_m * contact.penetration;
  if (contact.penetration > 0.0) contact.df_dp(2, 2) = Ke_N_per_m;
  return contact;
}

/// Joint and task reference of one joint motion.
[[nodiscard]] inline Reference referenceOf(const RobotModel& model, const JointVector& q, const JointVector& qd,
                                           const JointVector& qdd) {
  Kinematics kinematics;
  computeKinematics(model, q, qd, kinematics);
  Reference reference;
  reference.q = q;
  reference.qd = qd;
  reference.qdd = qdd;
  reference.has_task = true;
  reference.X_WE = kinematics.X_WE;
  reference.V_WE = kinematics.V_WE;
  reference.A_WE = kinematics.J * qdd + kinematics.Jdot_qd;
  return reference;
}

[[nodiscard]] inline Reference setPoint(const RobotModel& model, const JointVector& q) {
  const JointVector zero = JointVector::Zero(model.size());
  return referenceOf(model, q, zero, zero);
}

[[nodiscard]] inline RobotState stateOf(const RobotModel& model, const JointVector& q, const JointVector& qd) {
  Kinematics kinematics;
  computeKinematics(model, q, qd, kinematics);
  return {q, qd, kinematics.X_WE, kinematics.V_WE, JointVector::Zero(model.size())};
}

/// q_d = amplitude sin(t + phase), joint by joint.
[[nodiscard]] inline Reference sineReference(const RobotModel& model, double t) {
  const int n = model.size();
  JointVector q(n), qd(n);
  for (int i = 0; i < n; ++i) {
    q(i) = 0.2 * std::sin(t + i);
    qd(i) = 0.2 * std::cos(t + i);
  }
  return referenceOf(model, q, qd, -q);
}

struct ClosedLoop {
  RobotModel model;
  std::unique_ptr<Law> law;
  double dt_s;
  std::function<Reference(double)> reference;
  double Ke_N_per_m = 0.0;
  LawInput input;
  JointVector tau;  // last commanded effort
  double time_s = 0.0;

  ClosedLoop(const RobotModel& robot, std::unique_ptr<Law> controller, double dt, const JointVector& q0,
             std::function<Reference(double)> wanted)
      : model(robot), law(std::move(controller)), dt_s(dt), reference(std::move(wanted)) {
    input.dt_s = dt_s;
    input.state = stateOf(model, q0, JointVector::Zero(model.size()));
    law->reset();
  }

  /// One step; false when the law or the arm failed.
  [[nodiscard]] bool step() {
    JointVector q = input.state.q, qd = input.state.qd;
    input.contact = wallContact(Ke_N_per_m, input.state.X_WE.p);
    input.reference = reference(time_s);
    if (law->step(input, tau) != LawStatus::kOk) return false;
    JointVector applied = tau;
    saturateEffort(model, applied);
    if (!integrateStep(model, applied, input.contact, dt_s, 1, q, qd)) return false;
    input.state = stateOf(model, q, qd);
    input.state.tau_applied = applied;
    time_s += dt_s;
    return true;
  }

  void run(double duration_s) {
    for (double end = time_s + duration_s - dt_s / 2; time_s < end;) ASSERT_TRUE(step()) << "at " << time_s << " s";
  }

  [[nodiscard]] const JointVector& q() const { return input.state.q; }
  [[nodiscard]] Vector3 tip() const { return input.state.X_WE.p; }
  [[nodiscard]] Vector3 force() const { return wallContact(Ke_N_per_m, tip()).h_e.head<3>(); }
};

[[nodiscard]] inline JointVector gravityAt(const RobotModel& model, const JointVector& q) {
  JointVector g;
  gravityEffort(model, q, g);
  return g;
}

[[nodiscard]] inline JointMatrix massMatrixAt(const RobotModel& model, const JointVector& q) {
  JointMatrix B;
  massMatrix(model, q, B);
  return B;
}

[[nodiscard]] inline JointVector biasAt(const RobotModel& model, const JointVector& q, const JointVector& qd) {
  JointVector n;
  biasEffort(model, q, qd, n);
  return n;
}

}  // namespace baton::test
