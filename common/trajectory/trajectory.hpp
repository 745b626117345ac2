/// What the arm should do over time: a pure function of time, so it can be evaluated at any step in any order. Every
/// derivative is by formula.
#pragma once

#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "base/signals.hpp"
#include "base/types.hpp"
#include "robot/model.hpp"
#include "trajectory/hold_noise.hpp"
#include "trajectory/timing.hpp"

namespace baton {

/// Through joint waypoints, rest to rest between them; all joints start and arrive together. One waypoint is a
/// set-point. The first waypoint holds before its time, the last one after it.
struct JointPath {
  struct Waypoint {
    double time_s = 0.0;
    JointVector q;
  };
  Timing timing = {};
  std::vector<Waypoint> waypoints = {};  // at least one, times strictly increasing
};

/// The same for the tip: straight lines between positions, and a turn about one fixed axis, the shorter way round,
/// between orientations (Siciliano et al. 2009, sec. 4.3.2 and 4.3.3). There is no joint reference then: finding q is
/// the law's part.
struct TipPath {
  struct Waypoint {
    double time_s = 0.0;
    Pose X_WE;
  };
  Timing timing = {};
  std::vector<Waypoint> waypoints = {};  // at least one, times strictly increasing
};

/// q = offset + amplitude sin(frequency t + phase), joint by joint, at full speed from the start. It goes on without
/// end unless end_s is given: then its own time runs slower and slower over the last slow_down_s and stands still at
/// end_s, so that it comes to rest without a jump in acceleration, on the curve it was on.
struct JointSine {
  JointVector offset;               // rad or m
  JointVector amplitude;            // rad or m
  JointVector frequency_rad_per_s;  // angular
  JointVector phase_rad;
  double end_s = std::numeric_limits<double>::infinity();
  double slow_down_s = 1.0;  // positive; only matters with an end
};

struct TrajectorySpec {
  std::variant<JointPath, TipPath, JointSine> motion;
  std::optional<HoldNoise> noise = {};  // on the position of a joint reference
  Vector6 h_d = Vector6::Zero();        // desired wrench on the environment, constant [N; N m]
};

/// Throws UsageError naming the part that is wrong, what was expected and what was found: no waypoint, a vector of the
/// wrong size, a number out of range or not finite, an orientation that is no rotation, times that do not increase, or
/// noise without a joint reference. n is the joint count.
void checkTrajectory(const TrajectorySpec& spec, int n);

class Trajectory {
 public:
  /// Throws UsageError as checkTrajectory() does.
  Trajectory(const RobotModel& model, TrajectorySpec spec);

  /// Reference at time_s: the task part always, through the robot's kinematics where the motion is one of joints; the
  /// joint part unless the motion is the tip's. Never throws, never allocates.
  /// Noise is added to q and to nothing else. It stands for a disturbed command: qd and qdd, zero within a hold, stay
  /// those of the motion, and the tip's pose stays the undisturbed one, consistent with its own derivatives, for laws
  /// that follow it and for whoever measures what the noise has done.
  void evaluate(double time_s, Reference& out) const noexcept;

  /// When the motion is over and rest begins [s]; infinity for a sine without end. Noise goes on.
  [[nodiscard]] double endTime() const noexcept;

 private:
  RobotModel model_;
  TrajectorySpec spec_;
};

}  // namespace baton
