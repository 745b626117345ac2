/// The dynamics as a linear function of what is seldom known well: masses, first moments, inertias and viscous
/// friction.
#pragma once

#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// Per joint, in this order: the standard dynamic parameters of its link as LinkInertia has them,
///   m, m c_x, m c_y, m c_z, I_xx, I_xy, I_xz, I_yy, I_yz, I_zz   (elements of the matrix about the frame's origin),
/// and the joint's viscous friction.
inline constexpr int kParametersPerJoint = 11;

inline constexpr int kMaxParameters = kMaxJoints * kParametersPerJoint;
using DynamicParameters = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxParameters, 1>;
using Regressor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxParameters>;

/// pi, the parameters of the model: 11 n entries.
[[nodiscard]] DynamicParameters dynamicParameters(const RobotModel& model) noexcept;

/// Y with Y pi = B(q) a + C(q, qd) v + Fv v + g(q), C from Christoffel symbols, so that dB/dt - 2C is skew-symmetric.
/// At v = qd and a = qdd this is inverse dynamics with viscous friction (Siciliano et al. 2009, sec. 7.2.2); an
/// adaptive law takes reference velocities instead, and then it matters which C is meant. Of the model only the
/// geometry, the kinds of joints and gravity are read.
/// @param[out] Y  n x 11 n.
void dynamicsRegressor(const RobotModel& model, const JointVector& q, const JointVector& qd, const JointVector& v,
                       const JointVector& a, Regressor& Y) noexcept;

}  // namespace baton
