#include "environment/plane.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "base/error.hpp"

namespace baton {
namespace {

void requireNotNegative(const std::string& field, double value) {
  if (value >= 0.0 && std::isfinite(value)) return;
  std::ostringstream text;
  text << field << ": expected a finite number of at least 0, found " << value;
  throw UsageError(text.str());
}

}  // namespace

void checkPlane(const PlaneSpec& plane) {
  if (!plane.point_m.allFinite()) throw UsageError("point: expected finite numbers");
  if (!plane.normal.allFinite()) throw UsageError("normal: expected finite numbers");
  constexpr double kShortest = 1e-6;  // below, its direction is rounding
  if (plane.normal.norm() < kShortest) throw UsageError("normal: expected a direction, found a vector of length 0");
  requireNotNegative("stiffness", plane.stiffness_N_per_m);
  requireNotNegative("damping", plane.damping_N_s_per_m);
}

Contact planeContact(const PlaneSpec& plane, const Vector3& p_WE, const Vector3& v_WE) noexcept {
  Contact contact;
  const Vector3 n = plane.normal.normalized();
  const double depth = n.dot(p_WE - plane.point_m);
  if (plane.unilateral && !(depth > 0.0)) return contact;
  contact.penetration = std::abs(depth);
  const double force = plane.stiffness_N_per_m * depth + plane.damping_N_s_per_m * n.dot(v_WE);
  // Leaving faster than the material follows: in touch, without force.
  if (plane.unilateral && !(force > 0.0)) return contact;
  const Matrix3 nnT = n * n.transpose();
  contact.h_e.head<3>() = force * n;
  contact.df_dp = plane.stiffness_N_per_m * nnT;
  contact.df_dv = plane.damping_N_s_per_m * nnT;
  return contact;
}

Contact planesContact(const std::vector<PlaneSpec>& planes, const Vector3& p_WE, const Vector3& v_WE) noexcept {
  Contact total;
  for (const PlaneSpec& plane : planes) {
    const Contact one = planeContact(plane, p_WE, v_WE);
    total.h_e += one.h_e;
    total.df_dp += one.df_dp;
    total.df_dv += one.df_dv;
    total.penetration = std::max(total.penetration, one.penetration);
  }
  return total;
}

}  // namespace baton
