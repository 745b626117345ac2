#include "trajectory/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

/// Where on a path a time falls; derivatives with respect to time. At rest on a waypoint, s and its derivatives are 0.
template <typename Waypoint>
struct Place {
  const Waypoint& from;
  const Waypoint& to;
  Progress along;
};

template <typename Waypoint>
Place<Waypoint> locate(const Timing& timing, const std::vector<Waypoint>& waypoints, double time_s) noexcept {
  const auto next = std::upper_bound(waypoints.begin(), waypoints.end(), time_s,
                                     [](double time, const Waypoint& waypoint) { return time < waypoint.time_s; });
  if (next == waypoints.begin()) return {waypoints.front(), waypoints.front(), {}};
  if (next == waypoints.end()) return {waypoints.back(), waypoints.back(), {}};
  const Waypoint& from = *(next - 1);
  const double duration = next->time_s - from.time_s;
  Progress along = progressAt(timing, (time_s - from.time_s) / duration);
  along.ds /= duration;
  along.dds /= duration * duration;
  return {from, *next, along};
}

/// The sine's own time. Its rate falls from 1 to 0 as 1 - quintic(u), whose integral is u - u^4 (u^2 - 3 u + 5/2).
Progress sineTime(const JointSine& sine, double time_s) noexcept {
  const double slow_from_s = sine.end_s - sine.slow_down_s;
  if (time_s <= slow_from_s) return {time_s, 1.0, 0.0};
  const double u = std::min((time_s - slow_from_s) / sine.slow_down_s, 1.0);
  const Progress fall = progressAt({.interpolation = Interpolation::kQuintic}, u);
  const double integral = u - u * u * u * u * (u * (u - 3.0) + 2.5);
  return {slow_from_s + sine.slow_down_s * integral, 1.0 - fall.s, -fall.ds / sine.slow_down_s};
}

void evaluateJoints(const JointPath& path, double time_s, Reference& out) noexcept {
  const auto [from, to, along] = locate(path.timing, path.waypoints, time_s);
  const JointVector distance = to.q - from.q;
  out.q = from.q + along.s * distance;
  out.qd = along.ds * distance;
  out.qdd = along.dds * distance;
}

void evaluateJoints(const JointSine& sine, double time_s, Reference& out) noexcept {
  const Progress time = sineTime(sine, time_s);
  const Eigen::Index n = sine.offset.size();
  out.q.resize(n);
  out.qd.resize(n);
  out.qdd.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double w = sine.frequency_rad_per_s(i), angle = w * time.s + sine.phase_rad(i);
    const auto [sine_of, cosine_of] = elementary::sincos(angle);
    const double swing = sine.amplitude(i) * sine_of, slope = sine.amplitude(i) * w * cosine_of;
    out.q(i) = sine.offset(i) + swing;
    out.qd(i) = slope * time.ds;
    out.qdd(i) = slope * time.dds - w * w * swing * time.ds * time.ds;
  }
}

/// The task reference that goes with the joint reference.
void followJoints(const RobotModel& model, Reference& out) noexcept {
  Kinematics kinematics;
  computeKinematics(model, out.q, out.qd, kinematics);
  out.X_WE = kinematics.X_WE;
  out.V_WE = kinematics.V_WE;
  out.A_WE = kinematics.Jdot_qd;
  out.A_WE.noalias() += kinematics.J * out.qdd;
}

void evaluateTip(const TipPath& path, double time_s, Reference& out) noexcept {
  const auto [from, to, along] = locate(path.timing, path.waypoints, time_s);
  Vector6 way;  // the displacement, and the turn as axis x angle in W
  way.head<3>() = to.X_WE.p - from.X_WE.p;
  const Matrix3 R_turn = to.X_WE.R * from.X_WE.R.transpose();
  way.tail<3>() = rotationVector(R_turn);
  const double angle = way.tail<3>().norm();

  out.X_WE = from.X_WE;
  out.X_WE.p += along.s * way.head<3>();
  if (angle > 0.0) {
    const Vector3 axis = way.tail<3>() / angle;
    out.X_WE.R = rotationAbout(axis, along.s * angle) * from.X_WE.R;
  }
  out.V_WE = along.ds * way;
  out.A_WE = along.dds * way;
  out.q.resize(0);
  out.qd.resize(0);
  out.qdd.resize(0);
}

void addNoise(const HoldNoise& noise, double time_s, JointVector& q) noexcept {
  const std::int64_t hold = holdIndex(noise, time_s);
  for (int i = 0; i < static_cast<int>(q.size()); ++i) {
    q(i) += noise.standard_deviation(i) * standardNormal(noise.seed, hold, i);
  }
}

}  // namespace

Trajectory::Trajectory(const RobotModel& model, TrajectorySpec spec) : model_(model), spec_(std::move(spec)) {
  checkTrajectory(spec_, model_.size());
}

void Trajectory::evaluate(double time_s, Reference& out) const noexcept {
  out.has_task = true;
  out.h_d = spec_.h_d;
  if (const auto* tip = std::get_if<TipPath>(&spec_.motion)) return evaluateTip(*tip, time_s, out);

  if (const auto* path = std::get_if<JointPath>(&spec_.motion)) evaluateJoints(*path, time_s, out);
  if (const auto* sine = std::get_if<JointSine>(&spec_.motion)) evaluateJoints(*sine, time_s, out);
  followJoints(model_, out);
  if (spec_.noise) addNoise(*spec_.noise, time_s, out.q);
}

double Trajectory::endTime() const noexcept {
  if (const auto* path = std::get_if<JointPath>(&spec_.motion)) return path->waypoints.back().time_s;
  if (const auto* tip = std::get_if<TipPath>(&spec_.motion)) return tip->waypoints.back().time_s;
  return std::get_if<JointSine>(&spec_.motion)->end_s;
}

}  // namespace baton
