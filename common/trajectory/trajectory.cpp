#include "trajectory/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "base/error.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

/// Position along a segment and its derivatives with respect to u, all of u in [0, 1].
struct Progress {
  double s, ds, dds;
};

Progress progress(Interpolation interpolation, double u) noexcept {
  if (interpolation == Interpolation::kCubic) {
    return {u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u), 6.0 - 12.0 * u};
  }
  const double v = 1.0 - u;
  return {u * u * u * (10.0 + u * (6.0 * u - 15.0)), 30.0 * u * u * v * v, 60.0 * u * v * (v - u)};
}

void check(const TrajectorySpec& spec, int n) {
  const auto refuse = [](std::size_t index, const std::string& what) {
    throw UsageError("trajectory, waypoint " + std::to_string(index + 1) + ": " + what);
  };
  if (spec.waypoints.empty()) throw UsageError("trajectory: expected at least one waypoint, found none");
  for (std::size_t i = 0; i < spec.waypoints.size(); ++i) {
    const Waypoint& waypoint = spec.waypoints[i];
    if (waypoint.q.size() != n) {
      refuse(i, "expected " + std::to_string(n) + " joint positions, found " + std::to_string(waypoint.q.size()));
    }
    if (!std::isfinite(waypoint.time_s) || !waypoint.q.allFinite()) refuse(i, "expected finite numbers");
    if (i > 0 && !(waypoint.time_s > spec.waypoints[i - 1].time_s)) {
      std::ostringstream text;
      text << "expected a time after " << spec.waypoints[i - 1].time_s << " s, found " << waypoint.time_s << " s";
      refuse(i, text.str());
    }
  }
  if (!spec.h_d.allFinite()) throw UsageError("trajectory: expected a desired wrench of finite numbers");
}

}  // namespace

Trajectory::Trajectory(const RobotModel& model, TrajectorySpec spec) : model_(model), spec_(std::move(spec)) {
  check(spec_, model_.size());
}

void Trajectory::evaluate(double time_s, Reference& out) const noexcept {
  const auto next = std::upper_bound(spec_.waypoints.begin(), spec_.waypoints.end(), time_s,
                                     [](double time, const Waypoint& waypoint) { return time < waypoint.time_s; });
  if (next == spec_.waypoints.begin() || next == spec_.waypoints.end()) {
    out.q = next == spec_.waypoints.begin() ? next->q : spec_.waypoints.back().q;
    out.qd = JointVector::Zero(model_.size());
    out.qdd = JointVector::Zero(model_.size());
  } else {
    const Waypoint& from = *(next - 1);
    const double duration = next->time_s - from.time_s;
    const Progress along = progress(spec_.interpolation, (time_s - from.time_s) / duration);
    const JointVector distance = next->q - from.q;
    out.q = from.q + along.s * distance;
    out.qd = (along.ds / duration) * distance;
    out.qdd = (along.dds / (duration * duration)) * distance;
  }

  Kinematics kinematics;
  computeKinematics(model_, out.q, out.qd, kinematics);
  out.has_task = true;
  out.X_WE = kinematics.X_WE;
  out.V_WE = kinematics.V_WE;
  out.A_WE = kinematics.Jdot_qd;
  out.A_WE.noalias() += kinematics.J * out.qdd;
  out.h_d = spec_.h_d;
}

}  // namespace baton
