/// Lagrange's road to the dynamics, from the energies (Siciliano et al. 2009, sec. 7.1). It shares with the recursive
/// road the link frames and nothing else, and serves as its second opinion.
#include <Eigen/Geometry>
#include <array>

#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

using LinearJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxJoints>;

/// The axes of the joints and where they are; joint k moves whatever lies beyond it.
struct JointAxes {
  const RobotModel& model;
  const Kinematics& kinematics;

  [[nodiscard]] bool turns(int k) const { return model.joints[k].kind == JointKind::kRevolute; }
  [[nodiscard]] Vector3 axis(int k) const { return kinematics.X_WL[k].R.col(2); }
  [[nodiscard]] Vector3 origin(int k) const { return kinematics.X_WL[k].p; }

  /// d/dq_k of a point beyond joint k.
  [[nodiscard]] Vector3 pointDerivative(int k, const Vector3& p) const {
    return turns(k) ? axis(k).cross(p - origin(k)) : axis(k);
  }
  /// d/dq_k of a direction beyond joint k.
  [[nodiscard]] Vector3 directionDerivative(int k, const Vector3& u) const {
    return turns(k) ? axis(k).cross(u) : Vector3::Zero();
  }
};

/// Partial Jacobians of link l's centre of mass p and orientation; columns beyond joint l are zero.
void partialJacobians(const JointAxes& joints, int l, const Vector3& p, LinearJacobian& J_P, LinearJacobian& J_O) {
  J_P.setZero(3, joints.model.size());
  J_O.setZero(3, joints.model.size());
  for (int j = 0; j <= l; ++j) {
    J_P.col(j) = joints.pointDerivative(j, p);
    if (joints.turns(j)) J_O.col(j) = joints.axis(j);
  }
}

/// Their derivatives with respect to q_k, k <= l: joint k carries the axes and origins of the joints beyond it.
void partialJacobianDerivatives(const JointAxes& joints, int l, int k, const Vector3& p, LinearJacobian& dJ_P,
                                LinearJacobian& dJ_O) {
  dJ_P.setZero(3, joints.model.size());
  dJ_O.setZero(3, joints.model.size());
  const Vector3 dp = joints.pointDerivative(k, p);
  for (int j = 0; j <= l; ++j) {
    Vector3 d_axis = Vector3::Zero(), d_origin = Vector3::Zero();
    if (k < j) {
      d_axis = joints.directionDerivative(k, joints.axis(j));
      d_origin = joints.pointDerivative(k, joints.origin(j));
    }
    if (joints.turns(j)) {
      dJ_P.col(j) = d_axis.cross(p - joints.origin(j)) + joints.axis(j).cross(dp - d_origin);
      dJ_O.col(j) = d_axis;
    } else {
      dJ_P.col(j) = d_axis;
    }
  }
}

/// c_ij = sum over k of 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i) qd_k (eq. 7.44 and 7.45).
void christoffelMatrix(const std::array<JointMatrix, kMaxJoints>& dB, const JointVector& qd, JointMatrix& C) {
  const Eigen::Index n = qd.size();
  C.setZero(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) C(i, j) += 0.5 * (dB[k](i, j) + dB[j](i, k) - dB[i](j, k)) * qd(k);
    }
  }
}

}  // namespace

void lagrangeDynamics(const RobotModel& model, const JointVector& q, const JointVector& qd,
                      LagrangeTerms& out) noexcept {
  const int n = model.size();
  Kinematics kinematics;
  computeKinematics(model, q, qd, kinematics);
  const JointAxes joints{model, kinematics};

  out.B.setZero(n, n);
  out.g.setZero(n);
  std::array<JointMatrix, kMaxJoints> dB;  // dB[k] = dB/dq_k
  for (int k = 0; k < n; ++k) dB[k].setZero(n, n);

  LinearJacobian J_P, J_O, dJ_P, dJ_O;
  for (int l = 0; l < n; ++l) {
    const LinkInertia& link = model.joints[l].link;
    const Pose& X_WL = kinematics.X_WL[l + 1];
    const Vector3 p = X_WL.p + X_WL.R * link.centreOfMass();
    const Matrix3 I = X_WL.R * link.inertiaAtCentreOfMass() * X_WL.R.transpose();
    partialJacobians(joints, l, p, J_P, J_O);

    out.B += link.mass_kg * J_P.transpose() * J_P + J_O.transpose() * I * J_O;
    out.g -= link.mass_kg * J_P.transpose() * model.gravity_W;

    for (int k = 0; k <= l; ++k) {
      partialJacobianDerivatives(joints, l, k, p, dJ_P, dJ_O);
      // The inertia turns with the link: dI/dq_k = S(omega) I - I S(omega), omega the column of J_O.
      Matrix3 turned;
      for (int c = 0; c < 3; ++c) turned.col(c) = J_O.col(k).cross(I.col(c));
      const Matrix3 dI = turned + turned.transpose();
      const JointMatrix half = link.mass_kg * dJ_P.transpose() * J_P + dJ_O.transpose() * I * J_O;
      dB[k] += half + half.transpose() + J_O.transpose() * dI * J_O;
    }
  }
  christoffelMatrix(dB, qd, out.C);
}

}  // namespace baton
