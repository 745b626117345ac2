/// Shared mathematical types and the conventions of the whole project, written once.
///
/// Units are SI everywhere inside: m, rad, s, kg, N, N m.
/// Six-vectors are [linear; angular]: a twist is [v; omega], a wrench is [force; moment].
/// Frames are monogram: X_WE is the pose of E in W, R_WE its rotation, p_WE its position; W is the world, E the tip
/// (end effector). Unless its name says otherwise, a twist, wrench or Jacobian belongs to the tip's origin and is
/// expressed in W.
/// Joint vectors have one entry per joint, rad or m by joint kind; efforts are N m or N. The number of joints is a
/// run-time number up to kMaxJoints, and storage is inline, so nothing here allocates.
#pragma once

#include <Eigen/Core>

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || __FINITE_MATH_ONLY__
#error "Expected no fast-math: a run has the same bytes everywhere. Compile this file without -ffast-math and -Ofast."
#endif

namespace baton {

inline constexpr int kMaxJoints = 8;

using Vector3 = Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix3 = Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;

/// Position and orientation of one frame in another. Name variables X_AB: the pose of B in A.
struct Pose {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();

  /// X_AC = X_AB * X_BC.
  [[nodiscard]] Pose operator*(const Pose& X_BC) const { return {R * X_BC.R, p + R * X_BC.p}; }
};

}  // namespace baton
