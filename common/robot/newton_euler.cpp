/// Recursive Newton-Euler in link frames. Gravity is the base accelerating upwards, so it never appears as a force.
#include <Eigen/Geometry>
#include <array>

#include "robot/dynamics.hpp"
#include "robot/joint_transform.hpp"

namespace baton {

void inverseDynamics(const RobotModel& model, const JointVector& q, const JointVector& qd, const JointVector& qdd,
                     const Vector6& h_e, JointVector& tau) noexcept {
  const int n = model.size();
  std::array<JointTransform, kMaxJoints> transforms;
  std::array<Vector3, kMaxJoints> forces;   // that accelerate link i, in its own frame
  std::array<Vector3, kMaxJoints> moments;  // about its origin

  const JointTransform base(model.base);
  Vector3 omega = Vector3::Zero();
  Vector3 omega_dot = Vector3::Zero();
  Vector3 a = base.toLink(-model.gravity_W);  // acceleration of the origin
  Vector3 force = base.toLink(h_e.head<3>());
  Vector3 moment = base.toLink(h_e.tail<3>());

  // Outwards: the motion of each link, what it takes to move it so, and the tip's wrench turned along into its frame.
  for (int i = 0; i < n; ++i) {
    const Joint& joint = model.joints[i];
    const JointTransform& X = transforms[i] = JointTransform(joint, q(i));
    if (joint.kind == JointKind::kRevolute) {
      omega_dot += Vector3(qd(i) * omega.y(), -qd(i) * omega.x(), qdd(i));
      omega.z() += qd(i);
    } else {
      a += Vector3(2.0 * qd(i) * omega.y(), -2.0 * qd(i) * omega.x(), qdd(i));
    }
    omega = X.toLink(omega);
    omega_dot = X.toLink(omega_dot);
    a = X.toLink(a);
    force = X.toLink(force);
    moment = X.toLink(moment);

    // omega_dot x r + omega x (omega x r) = K r for every r fixed in the link.
    const double xx = omega.x() * omega.x(), yy = omega.y() * omega.y(), zz = omega.z() * omega.z();
    const double xy = omega.x() * omega.y(), xz = omega.x() * omega.z(), yz = omega.y() * omega.z();
    Matrix3 K;
    K << -yy - zz, xy - omega_dot.z(), xz + omega_dot.y(),  //
        xy + omega_dot.z(), -xx - zz, yz - omega_dot.x(),   //
        xz - omega_dot.y(), yz + omega_dot.x(), -xx - yy;
    a += K * X.offset();

    const LinkInertia& link = joint.link;
    const Vector3 angular_momentum = link.inertia_origin_kg_m2 * omega;
    forces[i] = link.mass_kg * a + K * link.first_moment_kg_m;
    moments[i] =
        link.inertia_origin_kg_m2 * omega_dot + omega.cross(angular_momentum) + link.first_moment_kg_m.cross(a);
  }

  // Inwards: each joint carries its link and all that hangs on it.
  tau.resize(n);
  for (int i = n - 1; i >= 0; --i) {
    const JointTransform& X = transforms[i];
    force += forces[i];
    moment += moments[i];
    X.toJoint(force);
    X.toJoint(moment);
    moment += X.moment(force);
    tau(i) = model.joints[i].kind == JointKind::kRevolute ? moment.z() : force.z();
    X.toPrevious(force);
    X.toPrevious(moment);
  }
}

void biasEffort(const RobotModel& model, const JointVector& q, const JointVector& qd, JointVector& n) noexcept {
  const JointVector no_acceleration = JointVector::Zero(model.size());
  inverseDynamics(model, q, qd, no_acceleration, Vector6::Zero(), n);
}

void gravityEffort(const RobotModel& model, const JointVector& q, JointVector& g) noexcept {
  const JointVector at_rest = JointVector::Zero(model.size());
  inverseDynamics(model, q, at_rest, at_rest, Vector6::Zero(), g);
}

}  // namespace baton
