/// The step from one link's frame to the next, A = Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha), as the recursions
/// use it: two plane turns and a shift instead of a 4 x 4 product. For the inside of common/robot only.
///
/// It passes through the joint's frame: the link's frame turned back by alpha and moved back by (a, 0, d). That frame
/// sits on the joint, turns with the link, and its z axis is the joint's axis.
#pragma once

#include "base/elementary.hpp"
#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// Turns (x, y) by the angle of this sine and cosine.
inline void turnPlane(double sine, double cosine, double& x, double& y) noexcept {
  const double turned = cosine * x - sine * y;
  y = sine * x + cosine * y;
  x = turned;
}

struct JointTransform {
  double sin_theta;
  double cos_theta;
  double sin_alpha;
  double cos_alpha;
  double a;
  double d;

  JointTransform() noexcept = default;  // left uninitialised, for arrays that are filled at once

  explicit JointTransform(const DhRow& row) noexcept
      : sin_theta(row.theta_rad.sine()),
        cos_theta(row.theta_rad.cosine()),
        sin_alpha(row.alpha_rad.sine()),
        cos_alpha(row.alpha_rad.cosine()),
        a(row.a_m),
        d(row.d_m) {}

  JointTransform(const Joint& joint, double q) noexcept : JointTransform(joint.dh) {
    if (joint.kind == JointKind::kRevolute) {
      const auto [sine, cosine] = elementary::sincos(q);
      turnPlane(sine, cosine, cos_theta, sin_theta);  // by q from the row's theta: quarter turns stay exact
    } else {
      d += q;
    }
  }

  /// From the previous link's origin to this link's, expressed in this link's frame.
  [[nodiscard]] Vector3 offset() const noexcept { return {a, d * sin_alpha, d * cos_alpha}; }

  /// A vector of the previous link's frame, expressed in this link's frame.
  [[nodiscard]] Vector3 toLink(Vector3 v) const noexcept {
    turnPlane(-sin_theta, cos_theta, v.x(), v.y());
    turnPlane(-sin_alpha, cos_alpha, v.y(), v.z());
    return v;
  }

  /// A vector of this link's frame, expressed in the joint's frame.
  void toJoint(Vector3& v) const noexcept { turnPlane(sin_alpha, cos_alpha, v.y(), v.z()); }

  /// A vector of the joint's frame, expressed in the previous link's frame.
  void toPrevious(Vector3& v) const noexcept { turnPlane(sin_theta, cos_theta, v.x(), v.y()); }

  /// The moment that `force` at the link's origin has about the joint's origin; both in the joint's frame.
  [[nodiscard]] Vector3 moment(const Vector3& force) const noexcept {
    return {-d * force.y(), d * force.x() - a * force.z(), a * force.y()};
  }

  /// The pose of this link, given that of the link before.
  [[nodiscard]] Pose applyTo(const Pose& X_WP) const noexcept {
    const Vector3 x = cos_theta * X_WP.R.col(0) + sin_theta * X_WP.R.col(1);
    const Vector3 y = cos_theta * X_WP.R.col(1) - sin_theta * X_WP.R.col(0);
    const auto z = X_WP.R.col(2);
    Pose X_WL;
    X_WL.R.col(0) = x;
    X_WL.R.col(1) = cos_alpha * y + sin_alpha * z;
    X_WL.R.col(2) = cos_alpha * z - sin_alpha * y;
    X_WL.p = X_WP.p + a * x + d * z;
    return X_WL;
  }
};

}  // namespace baton
