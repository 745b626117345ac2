/// What the files that read scenarios share: how a part is read and found wrong. Part of scenario_file.cpp; everybody
/// else wants scenario.hpp.
#pragma once

#include <string>
#include <vector>

#include "base/error.hpp"
#include "environment/plane.hpp"
#include "robot/model.hpp"
#include "runtime/yaml.hpp"
#include "trajectory/trajectory.hpp"

namespace baton {

inline constexpr double kMaxTime_s = 1e6;  // longer runs are open-ended

// Wide enough for any experiment, narrow enough to catch a slip of units or of a decimal point.
inline const NumberRange kTime{0.0, kMaxTime_s, "s"};
inline const NumberRange kJointPosition{-1e3, 1e3, "rad or m"};
inline const NumberRange kPoint{-1e3, 1e3, "m"};

/// Runs `read`; what it finds wrong is said to be at `node`.
template <typename Read>
decltype(auto) at(const YamlNode& node, const Read& read) {
  try {
    return read();
  } catch (const UsageError& error) {
    throw UsageError(node.place() + error.what());
  }
}

/// One number per joint.
[[nodiscard]] JointVector readJoints(const YamlNode& node, const NumberRange& range, int n);
/// The same, or a single number that stands for all joints.
[[nodiscard]] JointVector readJointsOrOne(const YamlNode& node, const NumberRange& range, int n);

/// The walls of an environment.
[[nodiscard]] std::vector<PlaneSpec> readWalls(const YamlNode& node);

/// @param start_q  where the arm starts: the orientation of a tip whose file does not give one.
[[nodiscard]] TrajectorySpec readTrajectory(const YamlNode& node, const RobotModel& robot, const JointVector& start_q);

}  // namespace baton
