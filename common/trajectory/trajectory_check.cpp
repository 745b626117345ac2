/// What a trajectory must be to be followed.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "base/error.hpp"
#include "trajectory/trajectory.hpp"

namespace baton {
namespace {

[[noreturn]] void refuse(const std::string& part, const std::string& what) {
  throw UsageError(part.empty() ? what : part + ": " + what);
}

std::string shown(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

void checkJoints(const std::string& part, const JointVector& values, int n) {
  if (values.size() != n) {
    refuse(part, "expected " + std::to_string(n) + " numbers, one per joint, found " + std::to_string(values.size()));
  }
  if (!values.allFinite()) refuse(part, "expected finite numbers");
}

void checkPlace(const std::string& part, const JointPath::Waypoint& waypoint, int n) {
  checkJoints(part, waypoint.q, n);
}

void checkPlace(const std::string& part, const TipPath::Waypoint& waypoint, int) {
  const Matrix3& R = waypoint.X_WE.R;
  constexpr double kRounding = 1e-9;
  if (!waypoint.X_WE.p.allFinite()) refuse(part, "expected finite numbers");
  const bool is_rotation = (R * R.transpose() - Matrix3::Identity()).norm() < kRounding && R.determinant() > 0.0;
  if (!is_rotation) refuse(part, "expected a rotation matrix");
}

// A sharper motion is a slip of the pen, and what it makes of the tip would leave the range of signals.
constexpr double kSharpest = 1e9;     // rad/s^2 or m/s^2
constexpr double kShortest_s = 1e-9;  // what lasts so long can be counted for as long as steps can

/// The largest acceleration along a segment of length 1 that takes a time of 1: of the quintic a fifth of the way in,
/// of the others at the start.
double peakAcceleration(const Timing& timing) {
  const double quintic_u = (3.0 - std::sqrt(3.0)) / 6.0;
  return std::max(std::abs(progressAt(timing, 0.0).dds), std::abs(progressAt(timing, quintic_u).dds));
}

double distance(const JointPath::Waypoint& from, const JointPath::Waypoint& to) {
  return (to.q - from.q).cwiseAbs().maxCoeff();
}

/// A turn is one of half a circle at most.
double distance(const TipPath::Waypoint& from, const TipPath::Waypoint& to) {
  constexpr double kHalfCircle = 3.14159265358979323846;
  return std::max((to.X_WE.p - from.X_WE.p).cwiseAbs().maxCoeff(), to.X_WE.R == from.X_WE.R ? 0.0 : kHalfCircle);
}

template <typename Path>
void checkPath(const Path& path, int n) {
  const double ramp = path.timing.ramp;
  if (!(ramp > 0.0 && ramp <= 0.5)) refuse("", "expected a ramp above 0 and up to 0.5, found " + shown(ramp));
  if (path.waypoints.empty()) refuse("", "expected at least one waypoint, found none");
  for (std::size_t i = 0; i < path.waypoints.size(); ++i) {
    const std::string part = "waypoint " + std::to_string(i + 1);
    const double time_s = path.waypoints[i].time_s;
    checkPlace(part, path.waypoints[i], n);
    if (!std::isfinite(time_s)) refuse(part, "expected a finite time");
    if (i > 0 && !(time_s > path.waypoints[i - 1].time_s)) {
      refuse(part,
             "expected a time after " + shown(path.waypoints[i - 1].time_s) + " s, found " + shown(time_s) + " s");
    }
    if (i == 0) continue;
    const double taken_s = time_s - path.waypoints[i - 1].time_s;
    const double peak = peakAcceleration(path.timing) * distance(path.waypoints[i - 1], path.waypoints[i]);
    const double least_s = std::max(kShortest_s, std::sqrt(peak / kSharpest));
    if (!(taken_s >= least_s)) {
      refuse(part,
             "expected at least " + shown(least_s) + " s after the waypoint before, found " + shown(taken_s) + " s");
    }
  }
}

void checkSine(const JointSine& sine, int n) {
  checkJoints("offset", sine.offset, n);
  checkJoints("amplitude", sine.amplitude, n);
  checkJoints("frequency", sine.frequency_rad_per_s, n);
  checkJoints("phase", sine.phase_rad, n);
  if (!(sine.slow_down_s > 0.0 && std::isfinite(sine.slow_down_s))) {
    refuse("", "expected a time to slow down above 0 s, found " + shown(sine.slow_down_s) + " s");
  }
  const bool ends = std::isfinite(sine.end_s);
  const double slow_down_per_s = ends ? 2.0 / sine.slow_down_s : 0.0;  // the quintic is steeper than 1, by 15/8
  const double peak = (sine.amplitude.array() * sine.frequency_rad_per_s.array() *
                       sine.frequency_rad_per_s.array().max(slow_down_per_s))
                          .abs()
                          .maxCoeff();
  if (!(peak <= kSharpest)) {
    refuse("", "expected an acceleration of at most " + shown(kSharpest) + " rad/s^2 or m/s^2, found " + shown(peak) +
                   ", from amplitude and frequency" + (ends ? " or the time to slow down" : ""));
  }
  if (!(sine.end_s >= sine.slow_down_s)) {
    refuse("", "expected an end not before the time to slow down, " + shown(sine.slow_down_s) + " s, found " +
                   shown(sine.end_s) + " s");
  }
}

void checkNoise(const TrajectorySpec& spec, int n) {
  if (!spec.noise) return;
  if (std::holds_alternative<TipPath>(spec.motion)) {
    refuse("noise", "expected a motion of joints, because noise is added to the joint reference, found one of the tip");
  }
  if (!(spec.noise->hold_s >= kShortest_s && std::isfinite(spec.noise->hold_s))) {
    refuse("noise", "expected a hold of at least 1e-9 s, found " + shown(spec.noise->hold_s) + " s");
  }
  checkJoints("noise", spec.noise->standard_deviation, n);
  if (spec.noise->standard_deviation.minCoeff() < 0.0) {
    refuse("noise", "expected standard deviations of at least 0");
  }
}

}  // namespace

void checkTrajectory(const TrajectorySpec& spec, int n) {
  if (const auto* path = std::get_if<JointPath>(&spec.motion)) checkPath(*path, n);
  if (const auto* tip = std::get_if<TipPath>(&spec.motion)) checkPath(*tip, n);
  if (const auto* sine = std::get_if<JointSine>(&spec.motion)) checkSine(*sine, n);
  checkNoise(spec, n);
  if (!spec.h_d.allFinite()) refuse("", "expected a desired wrench of finite numbers");
}

}  // namespace baton
