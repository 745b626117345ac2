/// The parts of a scenario that are worlds of their own: what the tip touches, and what is wanted of it.
#include "runtime/scenario_parts.hpp"

#include <limits>

#include "robot/kinematics.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxWaypoints = 10'000;
constexpr std::size_t kMaxWalls = 16;

const NumberRange kDirection{-1e6, 1e6, ""};
const NumberRange kStiffness{0.0, 1e9, "N/m"};
const NumberRange kDamping{0.0, 1e7, "N s/m"};
const NumberRange kForce{-1e6, 1e6, "N"};
const NumberRange kMoment{-1e6, 1e6, "N m"};
const NumberRange kPhaseOrOrientation{-100.0, 100.0, "rad"};
const NumberRange kFrequency{0.0, 1e5, "rad/s"};
const NumberRange kDeviation{0.0, 1e3, "rad or m"};
const NumberRange kRamp{0.0, 0.5, "of a segment's time", true};
const NumberRange kDuration{0.0, kMaxTime_s, "s", true};
const NumberRange kHold{1e-6, kMaxTime_s, "s"};

PlaneSpec readWall(const YamlNode& node) {
  const YamlMap wall = node.map({"point_m", "normal", "stiffness_N_per_m", "damping_N_s_per_m", "unilateral"});
  PlaneSpec plane;
  plane.point_m = wall["point_m"].vector3(kPoint);
  plane.normal = wall["normal"].vector3(kDirection);
  plane.stiffness_N_per_m = wall["stiffness_N_per_m"].number(kStiffness);
  plane.damping_N_s_per_m = wall.numberOr("damping_N_s_per_m", kDamping, plane.damping_N_s_per_m);
  plane.unilateral = wall.booleanOr("unilateral", plane.unilateral);
  at(node, [&] { checkPlane(plane); });
  return plane;
}

// --- trajectories

Timing readTiming(const YamlMap& map) {
  Timing timing;
  if (const auto word = map.find("interpolation")) {
    timing.interpolation = word->oneOf<Interpolation>({{"quintic", Interpolation::kQuintic},
                                                       {"cubic", Interpolation::kCubic},
                                                       {"trapezoidal", Interpolation::kTrapezoidal}});
  }
  if (const auto ramp = map.find("ramp")) {
    if (timing.interpolation != Interpolation::kTrapezoidal) {
      ramp->fail("expected interpolation: trapezoidal beside it, the only one that has a ramp, found another");
    }
    timing.ramp = ramp->number(kRamp);
  }
  return timing;
}

/// Later than the waypoint before.
template <typename Waypoint>
double readWaypointTime(const YamlMap& waypoint, const std::vector<Waypoint>& before) {
  const double time_s = waypoint["time_s"].number(kTime);
  if (!before.empty() && time_s <= before.back().time_s) {
    waypoint["time_s"].refuse("a time after the waypoint before, " + shownNumber(before.back().time_s) + " s");
  }
  return time_s;
}

/// ZYZ angles to a rotation; Siciliano et al. (2009), eq. 2.18.
Matrix3 readZyz(const YamlNode& node) {
  const Vector3 zyz = node.vector3(kPhaseOrOrientation);
  return rotationAbout(Vector3::UnitZ(), zyz.x()) * rotationAbout(Vector3::UnitY(), zyz.y()) *
         rotationAbout(Vector3::UnitZ(), zyz.z());
}

/// All waypoints are of joints, or all of the tip; the first one says which.
void readWaypoints(const YamlNode& node, const Timing& timing, const RobotModel& robot, const JointVector& start_q,
                   TrajectorySpec& trajectory) {
  JointPath joints{timing, {}};
  TipPath tip{timing, {}};
  Matrix3 R_WE = tipPose(robot, start_q).R;
  for (const YamlNode& item : node.list(1, kMaxWaypoints)) {
    const YamlMap waypoint = item.map({"time_s", "position", "tip_m", "tip_zyz_rad"});
    const auto position = waypoint.find("position"), tip_m = waypoint.find("tip_m");
    if (position.has_value() == tip_m.has_value()) {
      item.fail("expected either a position of the joints or tip_m, found " + std::string(tip_m ? "both" : "neither"));
    }
    const auto tip_zyz = waypoint.find("tip_zyz_rad");
    if (tip_zyz && !tip_m) tip_zyz->fail("expected tip_m beside it, found a position of the joints");
    if (tip_m ? !joints.waypoints.empty() : !tip.waypoints.empty()) {
      item.fail("expected all waypoints of one kind, positions of the joints or tip_m, found both kinds");
    }
    if (position) {
      const double time_s = readWaypointTime(waypoint, joints.waypoints);
      joints.waypoints.push_back({time_s, readJoints(*position, kJointPosition, robot.size())});
    } else {
      const double time_s = readWaypointTime(waypoint, tip.waypoints);
      if (tip_zyz) R_WE = readZyz(*tip_zyz);
      tip.waypoints.push_back({time_s, {R_WE, tip_m->vector3(kPoint)}});
    }
  }
  if (tip.waypoints.empty()) {
    trajectory.motion = std::move(joints);
  } else {
    trajectory.motion = std::move(tip);
  }
}

JointSine readSine(const YamlNode& node, int n) {
  const YamlMap map = node.map({"amplitude", "frequency_rad_per_s", "phase_rad", "offset", "end_s", "slow_down_s"});
  const auto joints_or_zero = [&](const char* key, const NumberRange& range) {
    const auto given = map.find(key);
    return given ? readJointsOrOne(*given, range, n) : JointVector(JointVector::Zero(n));
  };
  JointSine sine;
  sine.amplitude = readJointsOrOne(map["amplitude"], kJointPosition, n);
  sine.frequency_rad_per_s = readJointsOrOne(map["frequency_rad_per_s"], kFrequency, n);
  sine.phase_rad = joints_or_zero("phase_rad", kPhaseOrOrientation);
  sine.offset = joints_or_zero("offset", kJointPosition);
  sine.end_s = map.numberOr("end_s", kDuration, sine.end_s);
  if (const auto slow_down = map.find("slow_down_s")) {
    if (!map.has("end_s")) slow_down->fail("expected end_s beside it, found none");
    sine.slow_down_s = slow_down->number(kDuration);
  }
  return sine;
}

HoldNoise readNoise(const YamlNode& node, int n) {
  const YamlMap map = node.map({"hold_s", "standard_deviation", "seed"});
  HoldNoise noise;
  noise.hold_s = map["hold_s"].number(kHold);
  noise.standard_deviation = readJointsOrOne(map["standard_deviation"], kDeviation, n);
  noise.seed = static_cast<std::uint64_t>(map.integerOr("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  return noise;
}

}  // namespace

JointVector readJoints(const YamlNode& node, const NumberRange& range, int n) {
  const std::vector<double> values = node.numbers(static_cast<std::size_t>(n), range, "joint");
  return Eigen::Map<const JointVector>(values.data(), n);
}

JointVector readJointsOrOne(const YamlNode& node, const NumberRange& range, int n) {
  return node.isList() ? readJoints(node, range, n) : JointVector(JointVector::Constant(n, node.number(range)));
}

std::uint64_t readSteps(const YamlNode& node, const Scenario& scenario) {
  const double ns = node.number(kTime) * 1e9;
  const auto step_ns = static_cast<double>(scenario.step_ns);
  const double steps = std::round(ns / step_ns);
  constexpr double kRounding_ns = 0.5;            // a double of up to kMaxTime_s is finer
  const bool is_lost = steps == 0.0 && ns > 0.0;  // 0 has a meaning of its own
  if (is_lost || std::abs(ns - steps * step_ns) > kRounding_ns) {
    node.refuse("a whole number of steps of " + shownNumber(scenario.stepSeconds()) + " s (the nearest is " +
                shownNumber(steps * step_ns * 1e-9) + ")");
  }
  return static_cast<std::uint64_t>(steps);
}

std::string readMember(const YamlNode& node, const Scenario& scenario) {
  std::string name = node.text();
  at(node, [&] { (void)scenario.controller(name); });
  return name;
}

std::vector<PlaneSpec> readWalls(const YamlNode& node) {
  std::vector<PlaneSpec> walls;
  for (const YamlNode& wall : node.list(1, kMaxWalls)) walls.push_back(readWall(wall));
  return walls;
}

TrajectorySpec readTrajectory(const YamlNode& node, const RobotModel& robot, const JointVector& start_q) {
  const YamlMap map = node.map({"interpolation", "ramp", "waypoints", "sine", "noise", "force_N", "moment_Nm"});
  const auto waypoints = map.find("waypoints"), sine = map.find("sine");
  if (waypoints.has_value() == sine.has_value()) {
    node.fail("expected either waypoints or sine, found " + std::string(sine ? "both" : "neither"));
  }

  TrajectorySpec trajectory;
  // Each part is checked once it is there, so that a message can name its line.
  const auto check = [&] { checkTrajectory(trajectory, robot.size()); };
  if (waypoints) {
    readWaypoints(*waypoints, readTiming(map), robot, start_q, trajectory);
    at(*waypoints, check);
  } else {
    for (const char* key : {"interpolation", "ramp"}) {
      if (const auto timing = map.find(key)) timing->fail("expected waypoints beside it, found a sine");
    }
    trajectory.motion = readSine(*sine, robot.size());
    at(*sine, check);
  }
  if (const auto noise = map.find("noise")) {
    trajectory.noise = readNoise(*noise, robot.size());
    at(*noise, check);
  }
  if (const auto force = map.find("force_N")) trajectory.h_d.head<3>() = force->vector3(kForce);
  if (const auto moment = map.find("moment_Nm")) trajectory.h_d.tail<3>() = moment->vector3(kMoment);
  return trajectory;
}

}  // namespace baton
