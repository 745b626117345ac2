/// What the arm should do over time: a pure function of time, so it can be evaluated at any step in any order.
#pragma once

#include <vector>

#include "base/signals.hpp"
#include "base/types.hpp"
#include "robot/model.hpp"

namespace baton {

/// Rest to rest between waypoints; Siciliano et al. (2009), sec. 4.2. The cubic's acceleration jumps at waypoints,
/// where the value of the segment that begins there is given (zero once the last waypoint is reached).
enum class Interpolation { kCubic, kQuintic };

/// One waypoint in joint space.
struct Waypoint {
  double time_s = 0.0;
  JointVector q;
};

/// A motion through joint waypoints; one waypoint is a set-point. The first waypoint holds before its time, the last
/// one after it. Joint and task references both come out: the task one through the robot's kinematics.
struct TrajectorySpec {
  Interpolation interpolation = Interpolation::kQuintic;
  std::vector<Waypoint> waypoints;  // at least one, times strictly increasing
  Vector6 h_d = Vector6::Zero();    // desired wrench on the environment, constant [N; N m]
};

class Trajectory {
 public:
  /// Throws UsageError when a waypoint has the wrong size, a number is not finite or times do not increase.
  Trajectory(const RobotModel& model, TrajectorySpec spec);

  /// Joint and task reference at time_s. Never throws, never allocates.
  void evaluate(double time_s, Reference& out) const noexcept;

  /// When the motion is over and the last waypoint holds [s].
  [[nodiscard]] double endTime() const noexcept { return spec_.waypoints.back().time_s; }

 private:
  RobotModel model_;
  TrajectorySpec spec_;
};

}  // namespace baton
