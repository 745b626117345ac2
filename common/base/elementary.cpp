#include "base/elementary.hpp"

#include <sleef.h>

namespace baton::elementary {

double sin(double angle_rad) noexcept { return Sleef_cinz_sind1_u10purec(angle_rad); }

double cos(double angle_rad) noexcept { return Sleef_cinz_cosd1_u10purec(angle_rad); }

SinCos sincos(double angle_rad) noexcept {
  const Sleef_double_2 both = Sleef_cinz_sincosd1_u10purec(angle_rad);
  return {both.x, both.y};
}

double tanh(double x) noexcept { return Sleef_cinz_tanhd1_u10purec(x); }

double atan2(double y, double x) noexcept { return Sleef_cinz_atan2d1_u10purec(y, x); }

double hypot(double x, double y) noexcept { return Sleef_cinz_hypotd1_u05purec(x, y); }

}  // namespace baton::elementary
