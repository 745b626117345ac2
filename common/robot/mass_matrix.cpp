/// Composite rigid bodies (Featherstone, Rigid Body Dynamics Algorithms (2008), sec. 6.2), in the frames of the joints:
/// there a joint's column is read off the body that hangs on it.
#include <Eigen/Geometry>
#include <array>

#include "robot/dynamics.hpp"
#include "robot/joint_transform.hpp"

namespace baton {
namespace {

/// Turns the symmetric tensor with diagonal (aa, bb, .) and off-diagonal ab, ac, bc in the plane (a, b).
void turnTensor(double sine, double cosine, double& aa, double& bb, double& ab, double& ac, double& bc) noexcept {
  const double shear = sine * (aa - bb) + 2.0 * cosine * ab;
  aa -= sine * shear;
  bb += sine * shear;
  ab = cosine * shear - ab;
  turnPlane(sine, cosine, ac, bc);
}

/// All that hangs on a joint, taken as one rigid body.
struct CompositeBody {
  double mass = 0.0;
  Vector3 s = Vector3::Zero();  // first moment

  // Inertia about the origin.
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;

  void add(const LinkInertia& link) noexcept {
    const Matrix3& I = link.inertia_origin_kg_m2;
    mass += link.mass_kg;
    s += link.first_moment_kg_m;
    xx += I(0, 0), yy += I(1, 1), zz += I(2, 2);
    xy += I(1, 0), xz += I(2, 0), yz += I(2, 1);
  }

  /// From the link's frame to the joint's: turned by alpha, then moved by (a, 0, d) (parallel axes).
  void toJoint(const JointTransform& X) noexcept {
    X.toJoint(s);
    turnTensor(X.sin_alpha, X.cos_alpha, yy, zz, yz, xy, xz);
    const Vector3 s_at_link = s;
    s.x() += mass * X.a;
    s.z() += mass * X.d;
    const Vector3 t = s_at_link + s;
    const double ax = X.a * t.x(), dz = X.d * t.z();
    xx += dz;
    yy += ax + dz;
    zz += ax;
    xy -= 0.5 * X.a * t.y();
    xz -= 0.5 * (X.a * t.z() + X.d * t.x());
    yz -= 0.5 * X.d * t.y();
  }

  void toPrevious(const JointTransform& X) noexcept {
    X.toPrevious(s);
    turnTensor(X.sin_theta, X.cos_theta, xx, yy, xy, xz, yz);
  }
};

}  // namespace

void massMatrix(const RobotModel& model, const JointVector& q, JointMatrix& B) noexcept {
  const int n = model.size();
  std::array<JointTransform, kMaxJoints> transforms;
  for (int i = 0; i < n; ++i) transforms[i] = JointTransform(model.joints[i], q(i));

  B.resize(n, n);
  CompositeBody body;
  for (int i = n - 1; i >= 0; --i) {
    body.add(model.joints[i].link);
    body.toJoint(transforms[i]);

    // The wrench that gives the body a unit acceleration along joint i's axis, which is z here.
    const bool turns = model.joints[i].kind == JointKind::kRevolute;
    Vector3 force, moment;
    if (turns) {
      force << -body.s.y(), body.s.x(), 0.0;
      moment << body.xz, body.yz, body.zz;
    } else {
      force << 0.0, 0.0, body.mass;
      moment << body.s.y(), -body.s.x(), 0.0;
    }
    B(i, i) = turns ? body.zz : body.mass;

    // What each joint below must add to carry it.
    for (int j = i - 1; j >= 0; --j) {
      transforms[j + 1].toPrevious(force);
      transforms[j + 1].toPrevious(moment);
      transforms[j].toJoint(force);
      transforms[j].toJoint(moment);
      moment += transforms[j].moment(force);
      B(i, j) = B(j, i) = model.joints[j].kind == JointKind::kRevolute ? moment.z() : force.z();
    }
    body.toPrevious(transforms[i]);
  }
}

}  // namespace baton
