/// What flows round the control loop, as mathematics: the state, the contact, the reference and the command of a step.
/// The messages of idl/ are their wire form; common/messages converts one to the other.
#pragma once

#include "base/types.hpp"

namespace baton {

/// In the units below nothing real is larger; what is comes from a fault, and is refused where it is read.
inline constexpr double kLargestSignal = 1e12;
template <class Values>
[[nodiscard]] bool isInRange(const Eigen::DenseBase<Values>& values) {
  return (values.derived().array().abs() <= kLargestSignal).all();
}

/// What is measured at the start of a step.
struct RobotState {
  JointVector q;            // rad or m
  JointVector qd;           // rad/s or m/s
  Pose X_WE;                // tip pose
  Vector6 V_WE;             // tip twist [m/s; rad/s]
  JointVector tau_applied;  // effort applied over the step before, after saturation [N m or N]
};

/// What the environment feels at the tip, and how that changes as the tip moves, so that the plant can follow the force
/// inside a step.
struct Contact {
  Vector6 h_e = Vector6::Zero();    // wrench the tip exerts on the environment [N; N m]
  Matrix3 df_dp = Matrix3::Zero();  // derivative of the force with respect to tip position [N/m]
  Matrix3 df_dv = Matrix3::Zero();  // derivative of the force with respect to tip velocity [N s/m]
  double penetration = 0.0;         // depth of the tip in the environment, 0 out of contact [m]
};

/// What is wanted at a step. A joint reference has q, qd, qdd of n entries or none at all; the task reference is always
/// there when has_task is true.
struct Reference {
  JointVector q;
  JointVector qd;
  JointVector qdd;
  bool has_task = false;
  Pose X_WE;                       // desired tip pose
  Vector6 V_WE = Vector6::Zero();  // desired tip twist
  Vector6 A_WE = Vector6::Zero();  // desired tip acceleration, the time derivative of V_WE
  Vector6 h_d = Vector6::Zero();   // desired wrench on the environment, for laws that control force [N; N m]
};

}  // namespace baton
