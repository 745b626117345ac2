/// What the files that read scenarios share: how a part is read and found wrong. Part of scenario_file.cpp; everybody
/// else wants scenario.hpp.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "control/law.hpp"
#include "environment/plane.hpp"
#include "robot/model.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"
#include "trajectory/trajectory.hpp"

namespace baton {

inline constexpr double kMaxTime_s = 1e6;  // longer runs are open-ended
inline constexpr std::size_t kMaxControllers = 16;
inline constexpr int kMaxSubsteps = 1000;
inline constexpr std::int64_t kMinStep_ns = 1000;

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

/// A time as a count of steps. One that falls between two steps is refused rather than moved.
[[nodiscard]] std::uint64_t readSteps(const YamlNode& node, const Scenario& scenario);
/// The name of a controller of this scenario.
[[nodiscard]] std::string readMember(const YamlNode& node, const Scenario& scenario);

/// The baton's settings, and what is planned for it: all from the scenario's own map, into `scenario`, which has
/// everything else already.
void readBaton(const YamlMap& map, Scenario& scenario);
void readFailures(const YamlMap& map, Scenario& scenario);
void readSwaps(const YamlMap& map, Scenario& scenario);
void readStops(const YamlMap& map, Scenario& scenario);
/// What the recording is to hold, and how it is kept on the disk: from the scenario's `recording`.
void readRecordingShape(const YamlMap& map, const Scenario& scenario, RecordingConfig& recording);
/// The keys of it.
[[nodiscard]] const std::vector<std::string>& recordingShapeKeys();
/// The faults that are wanted, likewise.
void readFaults(const YamlMap& map, Scenario& scenario);

/// Some of a law's parameters, each of which may have that value in an arm of n joints.
[[nodiscard]] ParameterValues readParameters(const YamlNode& node, const LawInfo& law, int n);
/// Changes of parameters that are planned: from the scenario's own map, as readSwaps() does.
void readChanges(const YamlMap& map, Scenario& scenario);

/// The walls of an environment.
[[nodiscard]] std::vector<PlaneSpec> readWalls(const YamlNode& node);

/// Warns of friction and walls that the sub-steps are too long for: from the scenario, which has the world and the
/// trajectory already.
void warnOfFastPoles(const YamlMap& map, Scenario& scenario);

/// @param start_q  where the arm starts: the orientation of a tip whose file does not give one.
[[nodiscard]] TrajectorySpec readTrajectory(const YamlNode& node, const RobotModel& robot, const JointVector& start_q);

}  // namespace baton
