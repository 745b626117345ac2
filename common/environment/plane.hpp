/// An elastic half-space bounded by a plane, the report's wall: it pushes back along its normal in proportion to depth.
#pragma once

#include "base/signals.hpp"
#include "base/types.hpp"

namespace baton {

/// The material lies on the side the normal points to: depth = normal . (p_tip - point). The report's wall is the plane
/// z = z_r with normal (0, 0, 1), touched from below: h_e = (0, 0, Ke max(0, z_e - z_r)).
struct PlaneSpec {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal{0.0, 0.0, 1.0};   // any length but zero; normalised on use
  double stiffness_N_per_m = 0.0;  // >= 0
  double damping_N_s_per_m = 0.0;  // >= 0
};

/// Force the tip exerts on the plane and its derivatives at the tip position and velocity; unilateral: zero force and
/// zero derivatives out of contact, and the plane never pulls: where damping would make the sum negative, force and
/// derivatives are zero too.
[[nodiscard]] Contact planeContact(const PlaneSpec& plane, const Vector3& p_WE, const Vector3& v_WE) noexcept;

}  // namespace baton
