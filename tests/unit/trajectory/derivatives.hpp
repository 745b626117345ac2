/// What the tests of trajectories share: a reference at a time, and the check that each derivative is that of the
/// value.
#pragma once

#include <gtest/gtest.h>

#include "robot/kinematics.hpp"
#include "trajectory/trajectory.hpp"

namespace baton::test {

inline Reference referenceAt(const Trajectory& trajectory, double time_s) {
  Reference reference;
  trajectory.evaluate(time_s, reference);
  return reference;
}

/// Compares with central differences over 2 h. These are off by h^2 / 6 times the third derivative and by rounding,
/// 1e-15 of the value over h: h = 1e-5 leaves 2e-8 where the third derivative is below 1000.
inline void expectDerivatives(const Trajectory& trajectory, double time_s, double tolerance = 2e-8) {
  constexpr double h = 1e-5;
  const Reference now = referenceAt(trajectory, time_s), before = referenceAt(trajectory, time_s - h),
                  after = referenceAt(trajectory, time_s + h);
  if (now.q.size() > 0) {
    EXPECT_LT(((after.q - before.q) / (2 * h) - now.qd).norm(), tolerance) << time_s;
    EXPECT_LT(((after.qd - before.qd) / (2 * h) - now.qdd).norm(), tolerance) << time_s;
  }
  const Matrix3 R_turned = after.X_WE.R * before.X_WE.R.transpose();
  const Vector3 v_WE = now.V_WE.head<3>(), omega_WE = now.V_WE.tail<3>();
  EXPECT_LT(((after.X_WE.p - before.X_WE.p) / (2 * h) - v_WE).norm(), tolerance) << time_s;
  EXPECT_LT((rotationVector(R_turned) / (2 * h) - omega_WE).norm(), tolerance) << time_s;
  EXPECT_LT(((after.V_WE - before.V_WE) / (2 * h) - now.A_WE).norm(), tolerance) << time_s;
}

}  // namespace baton::test
