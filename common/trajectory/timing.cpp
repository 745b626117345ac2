#include "trajectory/timing.hpp"

namespace baton {
namespace {

Progress cubic(double u) noexcept { return {u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u), 6.0 - 12.0 * u}; }

Progress quintic(double u) noexcept {
  const double v = 1.0 - u;
  return {u * u * u * (10.0 + u * (6.0 * u - 15.0)), 30.0 * u * u * v * v, 60.0 * u * v * (v - u)};
}

Progress trapezoidal(double ramp, double u) noexcept {
  const double speed = 1.0 / (1.0 - ramp);  // the area below the trapezium is 1
  const double acceleration = speed / ramp;
  if (u < ramp) return {0.5 * acceleration * u * u, acceleration * u, acceleration};
  if (u < 1.0 - ramp) return {speed * (u - 0.5 * ramp), speed, 0.0};
  const double v = 1.0 - u;
  return {1.0 - 0.5 * acceleration * v * v, acceleration * v, -acceleration};
}

}  // namespace

Progress progressAt(const Timing& timing, double u) noexcept {
  switch (timing.interpolation) {
    case Interpolation::kCubic: return cubic(u);
    case Interpolation::kTrapezoidal: return trapezoidal(timing.ramp, u);
    case Interpolation::kQuintic: break;
  }
  return quintic(u);
}

}  // namespace baton
