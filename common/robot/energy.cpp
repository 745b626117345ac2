#include <Eigen/Geometry>

#include "robot/dynamics.hpp"
#include "robot/joint_transform.hpp"

namespace baton {

double kineticEnergy(const RobotModel& model, const JointVector& q, const JointVector& qd) noexcept {
  double energy = 0.0;
  Vector3 v = Vector3::Zero();  // of the link's origin, in its frame
  Vector3 omega = Vector3::Zero();
  for (int i = 0; i < model.size(); ++i) {
    const Joint& joint = model.joints[i];
    const JointTransform X(joint, q(i));
    (joint.kind == JointKind::kRevolute ? omega : v).z() += qd(i);
    omega = X.toLink(omega);
    v = X.toLink(v) + omega.cross(X.offset());
    energy += 0.5 * joint.link.mass_kg * v.squaredNorm() + v.dot(omega.cross(joint.link.first_moment_kg_m)) +
              0.5 * omega.dot(joint.link.inertia_origin_kg_m2 * omega);
  }
  return energy;
}

double potentialEnergy(const RobotModel& model, const JointVector& q) noexcept {
  double energy = 0.0;
  Pose X_WL = JointTransform(model.base).applyTo(Pose{});
  for (int i = 0; i < model.size(); ++i) {
    const LinkInertia& link = model.joints[i].link;
    X_WL = JointTransform(model.joints[i], q(i)).applyTo(X_WL);
    energy -= model.gravity_W.dot(link.mass_kg * X_WL.p + X_WL.R * link.first_moment_kg_m);
  }
  return energy;
}

}  // namespace baton
