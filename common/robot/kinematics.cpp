#include "robot/kinematics.hpp"

#include <Eigen/Geometry>

#include "robot/joint_transform.hpp"

namespace baton {

void computeKinematics(const RobotModel& model, const JointVector& q, const JointVector& qd, Kinematics& out) noexcept {
  const int n = model.size();
  out.X_WL[0] = JointTransform(model.base).applyTo(Pose{});

  // Outwards: the angular motion of each link, and the acceleration of its origin while no joint accelerates. All in W.
  Vector3 omega = Vector3::Zero();
  Vector3 omega_dot = Vector3::Zero();
  Vector3 v = Vector3::Zero();
  Vector3 v_dot = Vector3::Zero();
  for (int i = 0; i < n; ++i) {
    const Pose& X_WP = out.X_WL[i];
    const Pose& X_WL = out.X_WL[i + 1] = JointTransform(model.joints[i], q(i)).applyTo(X_WP);
    const Vector3 r = X_WL.p - X_WP.p;
    const Vector3 axis_rate = qd(i) * X_WP.R.col(2);
    if (model.joints[i].kind == JointKind::kRevolute) {
      omega_dot += omega.cross(axis_rate);
      omega += axis_rate;
    } else {
      v += axis_rate;
      v_dot += 2.0 * omega.cross(axis_rate);
    }
    const Vector3 v_r = omega.cross(r);
    v += v_r;
    v_dot += omega_dot.cross(r) + omega.cross(v_r);
  }
  out.X_WE = out.X_WL[n];
  out.V_WE << v, omega;
  out.Jdot_qd << v_dot, omega_dot;

  out.J.resize(Eigen::NoChange, n);
  for (int i = 0; i < n; ++i) {
    const Vector3 z = out.X_WL[i].R.col(2);
    if (model.joints[i].kind == JointKind::kRevolute) {
      out.J.col(i) << z.cross(out.X_WE.p - out.X_WL[i].p), z;
    } else {
      out.J.col(i) << z, Vector3::Zero();
    }
  }
}

Pose tipPose(const RobotModel& model, const JointVector& q) noexcept {
  Pose X = JointTransform(model.base).applyTo(Pose{});
  for (int i = 0; i < model.size(); ++i) X = JointTransform(model.joints[i], q(i)).applyTo(X);
  return X;
}

}  // namespace baton
