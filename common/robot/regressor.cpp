/// Newton-Euler's outward recursion with each velocity product replaced by its symmetric bilinear form, such as
/// omega x (omega x r) by the mean of omega x (omega_v x r) and omega_v x (omega x r). Why: Christoffel symbols are
/// symmetric in the two velocities, so C(q, qd) v is the symmetric bilinear form of the quadratic C(q, qd) qd, and a
/// quadratic form has only one.
#include "robot/regressor.hpp"

#include <Eigen/Geometry>
#include <array>

#include "robot/joint_transform.hpp"

namespace baton {
namespace {

constexpr int kParametersPerLink = kParametersPerJoint - 1;
using LinkWrench = Eigen::Matrix<double, 6, kParametersPerLink>;
using InertiaProduct = Eigen::Matrix<double, 3, 6>;

Matrix3 crossMatrix(const Vector3& w) {
  Matrix3 S;
  S << 0.0, -w.z(), w.y(),  //
      w.z(), 0.0, -w.x(),   //
      -w.y(), w.x(), 0.0;
  return S;
}

/// L(w) with I w = L(w) (I_xx, I_xy, I_xz, I_yy, I_yz, I_zz).
InertiaProduct inertiaProduct(const Vector3& w) {
  InertiaProduct L;
  L << w.x(), w.y(), w.z(), 0.0, 0.0, 0.0,  //
      0.0, w.x(), 0.0, w.y(), w.z(), 0.0,   //
      0.0, 0.0, w.x(), 0.0, w.y(), w.z();
  return L;
}

/// How a link moves, at its origin and in its frame, when one joint before it moves at unit speed.
struct UnitTwist {
  Vector3 v;
  Vector3 omega;
};

}  // namespace

DynamicParameters dynamicParameters(const RobotModel& model) noexcept {
  DynamicParameters pi(model.size() * kParametersPerJoint);
  for (int i = 0; i < model.size(); ++i) {
    const LinkInertia& link = model.joints[i].link;
    const Matrix3& I = link.inertia_origin_kg_m2;
    pi.segment<kParametersPerJoint>(i * kParametersPerJoint) << link.mass_kg, link.first_moment_kg_m, I(0, 0), I(0, 1),
        I(0, 2), I(1, 1), I(1, 2), I(2, 2), model.joints[i].friction.viscous;
  }
  return pi;
}

void dynamicsRegressor(const RobotModel& model, const JointVector& q, const JointVector& qd, const JointVector& v,
                       const JointVector& a, Regressor& Y) noexcept {
  const int n = model.size();
  Y.setZero(n, n * kParametersPerJoint);

  Vector3 omega = Vector3::Zero();    // of qd
  Vector3 omega_v = Vector3::Zero();  // of v
  Vector3 omega_dot = Vector3::Zero();
  Vector3 acceleration = JointTransform(model.base).toLink(-model.gravity_W);  // of the origin
  std::array<UnitTwist, kMaxJoints> twists;

  for (int i = 0; i < n; ++i) {
    const bool turns = model.joints[i].kind == JointKind::kRevolute;
    const JointTransform X(model.joints[i], q(i));

    // The link's motion: products of qd and v in place of products of qd with itself.
    const double x = v(i) * omega.x() + qd(i) * omega_v.x(), y = v(i) * omega.y() + qd(i) * omega_v.y();
    if (turns) {
      omega_dot += Vector3(0.5 * y, -0.5 * x, a(i));
      omega.z() += qd(i);
      omega_v.z() += v(i);
    } else {
      acceleration += Vector3(y, -x, a(i));
    }
    omega = X.toLink(omega);
    omega_v = X.toLink(omega_v);
    omega_dot = X.toLink(omega_dot);
    const Matrix3 product = omega * omega_v.transpose();
    const Matrix3 K =
        crossMatrix(omega_dot) + 0.5 * (product + product.transpose()) - product.trace() * Matrix3::Identity();
    acceleration = X.toLink(acceleration) + K * X.offset();

    // The wrench that moves the link so, about its origin: m a + K s and I omega_dot + omega x I omega_v + s x a, with
    // s the first moment.
    LinkWrench wrench = LinkWrench::Zero();
    wrench.block<3, 1>(0, 0) = acceleration;
    wrench.block<3, 3>(0, 1) = K;
    wrench.block<3, 3>(3, 1) = -crossMatrix(acceleration);
    wrench.block<3, 6>(3, 4) = inertiaProduct(omega_dot) + 0.5 * (crossMatrix(omega) * inertiaProduct(omega_v) +
                                                                  crossMatrix(omega_v) * inertiaProduct(omega));

    // Each joint up to here carries it along its own unit motion.
    twists[i] = turns ? UnitTwist{Vector3::Zero(), Vector3::UnitZ()} : UnitTwist{Vector3::UnitZ(), Vector3::Zero()};
    for (int j = 0; j <= i; ++j) {
      UnitTwist& twist = twists[j];
      twist.omega = X.toLink(twist.omega);
      twist.v = X.toLink(twist.v) + twist.omega.cross(X.offset());
      Y.block<1, kParametersPerLink>(j, i * kParametersPerJoint).noalias() =
          twist.v.transpose() * wrench.topRows<3>() + twist.omega.transpose() * wrench.bottomRows<3>();
    }
    Y(i, i * kParametersPerJoint + kParametersPerLink) = v(i);
  }
}

}  // namespace baton
