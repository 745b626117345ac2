/// Scenario files: a whole experiment in YAML, as deploy/scenarios/demo.yaml documents it, to a checked Scenario.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "base/error.hpp"
#include "control/law.hpp"
#include "control/nearest_name.hpp"
#include "robot/kinematics.hpp"
#include "runtime/paths.hpp"
#include "runtime/scenario.hpp"
#include "runtime/scenario_parts.hpp"
#include "runtime/service_options.hpp"
#include "runtime/yaml.hpp"
#include "time/pacer.hpp"

namespace baton {
namespace {

const NumberRange kJointVelocity{-1e4, 1e4, "rad/s or m/s"};
const NumberRange kCommandLimit{0.0, 1e9, "N m or N", true};

// --- time

std::int64_t readStep(const YamlNode& node) {
  const double ns = node.number({static_cast<double>(kMinStep_ns) / 1e9, 1.0, "s"}) * 1e9;
  constexpr double kRounding_ns = 1e-3;
  if (std::abs(ns - std::round(ns)) > kRounding_ns) node.refuse("a whole number of nanoseconds");
  return std::llround(ns);
}

double readRate(const YamlMap& map, SimMode mode) {
  const auto node = map.find("rate");
  const bool is_max = node && node->isScalar() && node->text() == "max";
  if (mode == SimMode::kRealtime) {
    if (node && (is_max || node->number() != 1.0)) node->refuse("1, the only rate of mode realtime");
    return 1.0;
  }
  return !node || is_max ? 0.0 : node->number({kMinRate, kMaxRate, "times real time, or max"});
}

/// A holder is given up in the step after those, so they and that step last 20 ms at most; at least one is forgiven.
std::int64_t defaultMissedSteps(std::int64_t step_ns) {
  constexpr std::int64_t kSilence_ns = 20'000'000;
  return std::clamp<std::int64_t>(kSilence_ns / step_ns - 1, 1, 20);
}

void readTime(const YamlMap& map, Scenario& scenario) {
  scenario.step_ns = readStep(map["step_s"]);
  scenario.substeps = static_cast<int>(map.integerOr("substeps", 1, kMaxSubsteps, scenario.substeps));
  if (const auto duration = map.find("duration_s")) scenario.end_step = readSteps(*duration, scenario);
  if (const auto mode = map.find("mode")) {
    scenario.mode = mode->oneOf<SimMode>({{"lockstep", SimMode::kLockstep}, {"realtime", SimMode::kRealtime}});
  }
  scenario.rate = readRate(map, scenario.mode);
  scenario.max_missed_steps =
      static_cast<std::uint64_t>(map.integerOr("max_missed_steps", 0, 1'000'000, defaultMissedSteps(scenario.step_ns)));
  if (const auto node = map.find("late")) {
    const YamlMap late = node->map({"policy", "after_s"});
    if (const auto policy = late.find("policy")) {
      scenario.late_policy = policy->oneOf<LatePolicy>(
          {{"wait", LatePolicy::kWait}, {"fallback", LatePolicy::kFallback}, {"abort", LatePolicy::kAbort}});
    }
    scenario.late_after_s = late.numberOr("after_s", {0.0, 86400.0, "s", true}, scenario.late_after_s);
  }
}

// --- the world

void readStart(const YamlMap& map, Scenario& scenario) {
  const int n = scenario.robot.size();
  scenario.start_q = JointVector::Zero(n);
  scenario.start_qd = JointVector::Zero(n);
  const auto node = map.find("start");
  if (!node) return;
  const YamlMap start = node->map({"position", "velocity"});
  if (const auto position = start.find("position")) scenario.start_q = readJoints(*position, kJointPosition, n);
  if (const auto velocity = start.find("velocity")) scenario.start_qd = readJoints(*velocity, kJointVelocity, n);
}

void readEffortLimit(const YamlMap& map, RobotModel& robot) {
  const auto node = map.find("effort_limit");
  if (!node) return;
  const JointVector limit = readJointsOrOne(*node, kCommandLimit, robot.size());
  for (int i = 0; i < robot.size(); ++i) robot.joints[static_cast<std::size_t>(i)].effort_limit = limit(i);
}

Coupling readCoupling(const YamlNode& node) {
  std::vector<std::pair<std::string, Coupling>> choices;
  for (const Coupling one : kCouplings) choices.emplace_back(toString(one), one);
  return node.oneOf(choices);
}

// --- controllers

/// A law says for itself whether the reference has the part that it follows: its first step tells, before a run does.
bool missesReference(Law& law, const Scenario& scenario) {
  LawInput input;
  input.dt_s = scenario.stepSeconds();
  Kinematics kinematics;
  computeKinematics(scenario.robot, scenario.start_q, scenario.start_qd, kinematics);
  input.state = {.q = scenario.start_q,
                 .qd = scenario.start_qd,
                 .X_WE = kinematics.X_WE,
                 .V_WE = kinematics.V_WE,
                 .tau_applied = JointVector::Zero(scenario.robot.size())};
  Trajectory(scenario.robot, scenario.trajectory).evaluate(0.0, input.reference);
  JointVector tau;
  law.reset();
  return law.step(input, tau) == LawStatus::kMissingReference;
}

ControllerConfig readController(const YamlNode& node, const Scenario& scenario) {
  const YamlMap map = node.map({"name", "law", "parameters"});
  ControllerConfig controller;
  controller.name = map["name"].name();
  if (roleCalled(controller.name) != dds::Role::kController) {
    map["name"].refuse("a name that is not that of another service of the run");
  }
  for (const ControllerConfig& other : scenario.controllers) {
    if (other.name == controller.name) map["name"].refuse("a name that no other controller of the scenario has");
  }

  controller.law = map["law"].text();
  const LawInfo& law = at(map["law"], [&]() -> const LawInfo& { return findLaw(controller.law); });
  if (law.uses_force && !scenario.hasEnvironment()) {
    map["law"].fail("expected an environment, because law " + law.name +
                    " uses force, found none; for free motion give a wall of stiffness 0");
  }
  const auto parameters = map.find("parameters");
  if (parameters) controller.parameters = readParameters(*parameters, law, scenario.robot.size());
  // A law may refuse a robot, or parameters that do not go together.
  const std::unique_ptr<Law> made =
      at(parameters.value_or(node), [&] { return makeLaw(law.name, scenario.robot, controller.parameters); });
  if (missesReference(*made, scenario)) {
    map["law"].fail(
        "expected a law that follows the tip, because the trajectory's waypoints are given as tip_m, found " +
        law.name + ", which follows joints");
  }
  controller.parameters = completeParameters(law.parameters, controller.parameters, scenario.robot.size());
  return controller;
}

/// none, chunk, or seconds.
void readSync(const YamlNode& node, RecordingConfig& recording) {
  const std::string word = node.isScalar() ? node.text() : "";
  if (word == "none") return;
  recording.sync_chunks = word == "chunk";
  if (!recording.sync_chunks) recording.sync_s = node.number({0.01, 3600.0, "s, or none, or chunk"});
}

RecordingConfig readRecording(const YamlMap& map, const Scenario& scenario) {
  RecordingConfig recording;
  constexpr double kCheckpoint_s = 1.0;
  recording.checkpoint_steps = std::max<std::uint64_t>(1, std::llround(kCheckpoint_s / scenario.stepSeconds()));
  const auto node = map.find("recording");
  if (!node) return recording;
  std::vector<std::string> keys{"enabled", "compression", "credit_steps", "checkpoint_s", "sync"};
  keys.insert(keys.end(), recordingShapeKeys().begin(), recordingShapeKeys().end());
  const YamlMap given = node->map(keys);
  if (const auto every = given.find("checkpoint_s")) recording.checkpoint_steps = readSteps(*every, scenario);
  recording.enabled = given.booleanOr("enabled", recording.enabled);
  if (const auto word = given.find("compression")) {
    recording.compression = word->oneOf<std::string>({{"none", "none"}, {"lz4", "lz4"}, {"zstd", "zstd"}});
  }
  recording.credit_steps = static_cast<std::uint64_t>(given.integerOr("credit_steps", 16, 512, 256));
  if (const auto sync = given.find("sync")) readSync(*sync, recording);
  readRecordingShape(given, scenario, recording);
  return recording;
}

// --- the whole

struct RobotFile {
  std::string shown_as;  // in messages
  std::string path;
  std::string text;
};

/// @param robot_file  finds the robot file that the node names.
Scenario readScenario(const std::string& file, const std::string& text,
                      const std::function<RobotFile(const YamlNode&)>& robot_file) {
  const YamlMap map =
      YamlNode::parse(file, text).map({"name",         "description", "robot",       "step_s",     "substeps",
                                       "duration_s",   "mode",        "rate",        "late",       "max_missed_steps",
                                       "effort_limit", "start",       "environment", "trajectory", "controllers",
                                       "active",       "standby",     "swaps",       "failures",   "stops",
                                       "baton",        "recording",   "faults",      "changes"});
  Scenario scenario;
  scenario.file = file;
  scenario.text = text;
  scenario.name = map["name"].name();
  if (const auto description = map.find("description")) scenario.description = description->text(400);
  const RobotFile robot = robot_file(map["robot"]);
  scenario.robot_file = robot.path;
  scenario.robot_text = robot.text;
  scenario.robot = parseRobot(robot.shown_as, robot.text, &scenario.warnings);
  readEffortLimit(map, scenario.robot);

  readTime(map, scenario);
  readStart(map, scenario);
  if (const auto environment = map.find("environment")) {
    const YamlMap world = environment->map({"walls", "coupling"});
    scenario.walls = readWalls(world["walls"]);
    if (const auto coupling = world.find("coupling")) scenario.coupling = readCoupling(*coupling);
  }
  scenario.trajectory = readTrajectory(map["trajectory"], scenario.robot, scenario.start_q);
  warnOfFastPoles(map, scenario);
  for (const YamlNode& controller : map["controllers"].list(1, kMaxControllers)) {
    scenario.controllers.push_back(readController(controller, scenario));
  }
  scenario.active = readMember(map["active"], scenario);
  if (const auto standby = map.find("standby")) {
    scenario.hot_standby = standby->oneOf<bool>({{"hot", true}, {"cold", false}});
  }
  readBaton(map, scenario);
  readFailures(map, scenario);
  readSwaps(map, scenario);
  readStops(map, scenario);
  readChanges(map, scenario);
  scenario.recording = readRecording(map, scenario);
  readFaults(map, scenario);
  return scenario;
}

}  // namespace

ArmConfig Scenario::armConfig() const {
  return {
      .step_s = stepSeconds(), .substeps = substeps, .start_q = start_q, .start_qd = start_qd, .coupling = coupling};
}

bool Scenario::hasCheckpointAt(std::uint64_t step) const {
  const bool is_due =
      step != 0 && (step == end_step || (recording.checkpoint_steps > 0 && step % recording.checkpoint_steps == 0));
  return is_due && std::none_of(faults.begin(), faults.end(), [&](const Fault& fault) {
           return fault.kind == FaultKind::kStuck && strikes(fault, step);
         });
}

bool Scenario::wantsFaultOf(const std::string& service) const {
  return std::any_of(faults.begin(), faults.end(), [&](const Fault& fault) { return fault.service == service; });
}

bool Scenario::plansFailureOf(const std::string& controller_name) const {
  return std::any_of(failures.begin(), failures.end(),
                     [&](const PlannedFailure& failure) { return failure.controller == controller_name; });
}

const ControllerConfig& Scenario::controller(const std::string& controller_name) const {
  std::vector<std::string> known;
  for (const ControllerConfig& one : controllers) {
    if (one.name == controller_name) return one;
    known.push_back(one.name);
  }
  throw UsageError(unknownName("controller", controller_name, known));
}

std::vector<ParameterChange> Scenario::changesOf(const std::string& controller_name) const {
  std::vector<ParameterChange> theirs;
  for (const PlannedChange& planned : changes) {
    if (planned.controller == controller_name) theirs.push_back(planned.change);
  }
  return theirs;
}

Scenario loadScenario(const std::string& path, const std::string& robot_path) {
  namespace fs = std::filesystem;
  Scenario scenario = readScenario(path, readYamlFile(path), [&](const YamlNode& node) -> RobotFile {
    // "rpp" is one that comes with Baton, anything else a file beside the scenario.
    const std::string word = node.text();
    const bool is_bare = word.find_first_of("./") == std::string::npos;
    const fs::path named =
        is_bare ? dataFolder() / "robots" / (word + ".yaml") : (fs::path(path).parent_path() / word).lexically_normal();
    const fs::path robot = robot_path.empty() ? named : fs::path(robot_path);
    return at(node, [&] {
      return RobotFile{robot.string(), fs::absolute(robot).lexically_normal().string(), readYamlFile(robot.string())};
    });
  });
  scenario.file = fs::absolute(path).lexically_normal().string();
  return scenario;
}

Scenario parseScenario(const std::string& file, const std::string& text, const std::string& robot_file,
                       const std::string& robot_text) {
  return readScenario(file, text, [&](const YamlNode& node) -> RobotFile {
    (void)node.text();
    return {robot_file, robot_file, robot_text};
  });
}

}  // namespace baton
