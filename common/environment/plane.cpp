#include "environment/plane.hpp"

namespace baton {

Contact planeContact(const PlaneSpec& plane, const Vector3& p_WE, const Vector3& v_WE) noexcept {
  Contact contact;
  const Vector3 n = plane.normal.normalized();
  const double depth = n.dot(p_WE - plane.point_m);
  if (!(depth > 0.0)) return contact;
  contact.penetration = depth;
  const double force = plane.stiffness_N_per_m * depth + plane.damping_N_s_per_m * n.dot(v_WE);
  if (!(force > 0.0)) return contact;  // leaving faster than the material follows: in touch, without force
  const Matrix3 nnT = n * n.transpose();
  contact.h_e.head<3>() = force * n;
  contact.df_dp = plane.stiffness_N_per_m * nnT;
  contact.df_dv = plane.damping_N_s_per_m * nnT;
  return contact;
}

}  // namespace baton
