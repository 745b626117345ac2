/// Elastic planes: half-spaces that push the tip back along their normals in proportion to depth, like the report's
/// wall, or spring planes that hold it from both sides. An environment is any number of them.
#pragma once

#include <vector>

#include "base/signals.hpp"
#include "base/types.hpp"

namespace baton {

/// The material lies on the side the normal points to: depth = normal . (p_tip - point). The report's wall is the plane
/// z = z_r with normal (0, 0, 1), touched from below: h_e = (0, 0, Ke max(0, z_e - z_r)).
/// One plane takes force along its normal alone. A force with other components is in balance only where planes with
/// other normals are.
struct PlaneSpec {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal{0.0, 0.0, 1.0};   // any length but zero; normalised on use
  double stiffness_N_per_m = 0.0;  // >= 0
  double damping_N_s_per_m = 0.0;  // >= 0
  bool unilateral = true;          // pushes only; otherwise a spring about the plane that pulls as well
};

/// Throws UsageError saying which field is wrong, what was expected and what was found.
void checkPlane(const PlaneSpec& plane);

/// Force the tip exerts on the plane, stiffness x depth + damping x rate of depth along the normal, and its derivatives
/// at the tip's position and velocity.
/// Unilateral: zero force and zero derivatives out of contact, and the plane never pulls: where damping would make the
/// sum negative, force and derivatives are zero too. Otherwise the tip is always in contact, and the penetration is its
/// distance from the plane.
[[nodiscard]] Contact planeContact(const PlaneSpec& plane, const Vector3& p_WE, const Vector3& v_WE) noexcept;

/// All planes at once: forces and derivatives add up; the penetration is the deepest.
[[nodiscard]] Contact planesContact(const std::vector<PlaneSpec>& planes, const Vector3& p_WE,
                                    const Vector3& v_WE) noexcept;

}  // namespace baton
