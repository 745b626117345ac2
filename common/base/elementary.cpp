#include "base/elementary.hpp"

#include <dlfcn.h>
#include <sleef.h>

#include <filesystem>

namespace baton::elementary {

std::string library() {
  // A shared library can be a later one than its header was; a file libsleef.so.3.6.1 names the release.
  Dl_info loaded{};
  if (dladdr(reinterpret_cast<void*>(&Sleef_cinz_sind1_u10purec), &loaded) != 0 && loaded.dli_fname != nullptr) {
    std::error_code unresolved;
    const std::string file = std::filesystem::canonical(loaded.dli_fname, unresolved).filename();
    const std::string stem = "libsleef.so.";
    if (file.starts_with(stem)) return "SLEEF " + file.substr(stem.size());
  }
  return "SLEEF " + std::to_string(SLEEF_VERSION_MAJOR) + "." + std::to_string(SLEEF_VERSION_MINOR) + "." +
         std::to_string(SLEEF_VERSION_PATCHLEVEL);
}

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
