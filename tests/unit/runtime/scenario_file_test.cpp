#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "bad_input.hpp"
#include "control/law.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

using test::BadInput;
using test::deployFolder;
using test::refusal;
using test::replaced;
using test::rppScenario;

constexpr double kPi = 3.14159265358979323846;

const char* const kTrial = R"(name: trial
description: one line
robot: rpp.yaml
step_s: 0.0005
substeps: 4
duration_s: 8
mode: lockstep
rate: max
late: {policy: fallback, after_s: 12}
max_missed_steps: 7
start: {position: [0.1, 0.2, 0.3], velocity: [1, 2, 4]}
environment:
  walls:
    - {point_m: [0, 0, 0.70], normal: [0, 0, 2], stiffness_N_per_m: 200, damping_N_s_per_m: 5}
  coupling: late
trajectory:
  interpolation: cubic
  waypoints:
    - {time_s: 0, position: [0, 0, 0]}
    - {time_s: 2, position: [pi/6, 0.25, 0.15]}
  force_N: [0, 0, 3]
  moment_Nm: [0.5, 0, 0]
controllers:
  - name: tracking
    law: operational_inverse_dynamics
    parameters:
      kp: [280, 280, 70, 70, 70, 70]
      kd: 30
      solver: position
  - name: impedance
    law: impedance
  - name: force
    law: force_pi
    parameters: {kp: 100}
active: tracking
standby: cold
swaps:
  - {at_s: 1.0, to: impedance}
  - {at_s: 4.0, to: force}
baton: {margin_steps: 6, blend_s: 0.15, max_effort_step: 40, max_effort_rate: [300, 200, 100], fallback: [impedance, tracking]}
recording: {enabled: false, compression: lz4, credit_steps: 64, sync: 0.5}
)";

Scenario parse(const std::string& text) { return rppScenario("trial.yaml", text); }

/// kTrial from the beginning of one text to the beginning of another, for cutting out whole sections.
std::string section(const std::string& from, const std::string& to) {
  const std::string text = kTrial;
  return text.substr(text.find(from), text.find(to) - text.find(from));
}

TEST(ScenarioFile, GivesEachFieldItsPlace) {
  const Scenario s = parse(kTrial);
  EXPECT_EQ(s.file, "trial.yaml");
  EXPECT_EQ(s.text, kTrial);
  EXPECT_EQ(s.robot_file, "rpp.yaml");
  EXPECT_EQ(s.robot_text, readYamlFile((deployFolder() / "robots/rpp.yaml").string()));
  EXPECT_EQ(s.name, "trial");
  EXPECT_EQ(s.description, "one line");
  EXPECT_EQ(s.robot.name, "rpp");
  EXPECT_TRUE(s.warnings.empty());
  EXPECT_EQ(s.step_ns, 500'000);
  EXPECT_EQ(s.substeps, 4);
  EXPECT_EQ(s.end_step, 16'000u);
  EXPECT_EQ(s.mode, SimMode::kLockstep);
  EXPECT_EQ(s.rate, 0.0);
  EXPECT_EQ(s.late_policy, LatePolicy::kFallback);
  EXPECT_EQ(s.late_after_s, 12.0);
  EXPECT_EQ(s.max_missed_steps, 7u);
  EXPECT_EQ(s.start_q, JointVector(Vector3(0.1, 0.2, 0.3)));
  EXPECT_EQ(s.start_qd, JointVector(Vector3(1.0, 2.0, 4.0)));

  ASSERT_EQ(s.walls.size(), 1u);
  EXPECT_TRUE(s.hasEnvironment());
  EXPECT_EQ(s.coupling, Coupling::kLate);
  EXPECT_EQ(s.armConfig().coupling, Coupling::kLate);
  EXPECT_EQ(s.walls[0].point_m, Vector3(0.0, 0.0, 0.7));
  EXPECT_EQ(s.walls[0].normal, Vector3(0.0, 0.0, 2.0));
  EXPECT_EQ(s.walls[0].stiffness_N_per_m, 200.0);
  EXPECT_EQ(s.walls[0].damping_N_s_per_m, 5.0);
  EXPECT_TRUE(s.walls[0].unilateral);

  const auto& path = std::get<JointPath>(s.trajectory.motion);
  EXPECT_EQ(path.timing.interpolation, Interpolation::kCubic);
  ASSERT_EQ(path.waypoints.size(), 2u);
  EXPECT_EQ(path.waypoints[1].time_s, 2.0);
  EXPECT_EQ(path.waypoints[1].q, JointVector(Vector3(kPi / 6.0, 0.25, 0.15)));
  EXPECT_FALSE(s.trajectory.noise.has_value());
  EXPECT_EQ(s.trajectory.h_d, (Vector6() << 0.0, 0.0, 3.0, 0.5, 0.0, 0.0).finished());

  ASSERT_EQ(s.controllers.size(), 3u);
  EXPECT_EQ(s.controllers[0].name, "tracking");
  EXPECT_EQ(s.controllers[0].law, "operational_inverse_dynamics");
  EXPECT_EQ(numbers(s.controllers[0].parameters, "kp"), (std::vector<double>{280, 280, 70, 70, 70, 70}));
  EXPECT_EQ(numbers(s.controllers[0].parameters, "kd"), std::vector<double>(6, 30.0));
  EXPECT_EQ(choice(s.controllers[0].parameters, "solver"), "position");
  EXPECT_EQ(s.controller("force").law, "force_pi");
  EXPECT_EQ(s.active, "tracking");
  EXPECT_FALSE(s.hot_standby);

  ASSERT_EQ(s.swaps.size(), 2u);
  EXPECT_EQ(s.swaps[0].at_step, 2'000u);
  EXPECT_EQ(s.swaps[0].to, "impedance");
  EXPECT_EQ(s.swaps[1].at_step, 8'000u);
  EXPECT_EQ(s.baton.margin_steps, 6u);
  EXPECT_EQ(s.baton.blend_steps, 300u);
  EXPECT_EQ(s.baton.max_effort_step, 40.0);
  EXPECT_EQ(s.baton.max_effort_rate, JointVector(Vector3(300.0, 200.0, 100.0)));
  EXPECT_EQ(s.baton.fallback, (std::vector<std::string>{"impedance", "tracking"}));
  EXPECT_FALSE(s.recording.enabled);
  EXPECT_EQ(s.recording.compression, "lz4");
  EXPECT_EQ(s.recording.credit_steps, 64u);
  EXPECT_EQ(s.recording.sync_s, 0.5);
  EXPECT_FALSE(s.recording.sync_chunks);
}

TEST(ScenarioFile, CompletesTheParametersOfEachLaw) {
  for (const ControllerConfig& controller : parse(kTrial).controllers) {
    for (const ParameterSpec& spec : findLaw(controller.law).parameters) {
      EXPECT_TRUE(controller.parameters.contains(spec.name)) << controller.name << " " << spec.name;
    }
  }
}

TEST(ScenarioFile, NeedsNoMoreThanARobotAStepAMotionAndAController) {
  const Scenario s = parse(
      "name: least\nrobot: rpp.yaml\nstep_s: 0.001\ntrajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}\n"
      "controllers: [{name: pd, law: joint_pd}]\nactive: pd\n");
  const Scenario defaults;
  EXPECT_EQ(s.substeps, defaults.substeps);
  EXPECT_EQ(s.end_step, 0u);
  EXPECT_EQ(s.mode, defaults.mode);
  EXPECT_EQ(s.rate, 0.0);
  EXPECT_EQ(s.max_missed_steps, 19u);  // and one more: 20 ms
  EXPECT_EQ(s.late_policy, defaults.late_policy);
  EXPECT_EQ(s.late_after_s, defaults.late_after_s);
  EXPECT_EQ(s.coupling, defaults.coupling);
  EXPECT_EQ(s.start_q, JointVector(Vector3::Zero()));
  EXPECT_EQ(s.start_qd, JointVector(Vector3::Zero()));
  EXPECT_FALSE(s.hasEnvironment());
  EXPECT_EQ(std::get<JointPath>(s.trajectory.motion).timing.interpolation, Interpolation::kQuintic);
  EXPECT_TRUE(s.hot_standby);
  EXPECT_TRUE(s.swaps.empty());
  EXPECT_EQ(s.baton.margin_steps, defaults.baton.margin_steps);
  EXPECT_EQ(s.baton.blend_steps, 100u);  // 0.1 s
  EXPECT_EQ(s.baton.max_effort_step, defaults.baton.max_effort_step);
  EXPECT_EQ(s.baton.max_effort_rate, JointVector(Vector3::Constant(1000.0)));
  EXPECT_TRUE(s.baton.fallback.empty());
  EXPECT_TRUE(s.recording.enabled);
  EXPECT_EQ(s.recording.compression, defaults.recording.compression);
  EXPECT_EQ(s.recording.credit_steps, defaults.recording.credit_steps);
}

TEST(ScenarioFile, MayRunUntilStopped) {
  EXPECT_EQ(parse(replaced(kTrial, "duration_s: 8\n", "duration_s: 0\n")).end_step, 0u);
  EXPECT_EQ(parse(replaced(kTrial, "duration_s: 8\n", "")).end_step, 0u);
}

TEST(ScenarioFile, CountsStepsExactlyWhereSecondsAreNotBinary) {
  // 0.1 and 0.3 are no binary fractions, and 0.3 / 0.1 is below 3.
  EXPECT_EQ(
      parse(replaced(replaced(kTrial, "step_s: 0.0005", "step_s: 0.1"), section("swaps:", "baton:"), "")).end_step,
      80u);
  const std::string third = replaced(kTrial, "step_s: 0.0005", "step_s: 0.0003");
  EXPECT_EQ(
      parse(replaced(replaced(third, "duration_s: 8", "duration_s: 8.1"), section("swaps:", "baton:"), "")).end_step,
      27'000u);
  EXPECT_EQ(
      parse(replaced(replaced(kTrial, "step_s: 0.0005", "step_s: 0.000125"), "duration_s: 8", "duration_s: 36000"))
          .end_step,
      288'000'000u);
}

TEST(ScenarioFile, PacesToAFactorOfRealTimeAndInRealtimeToOne) {
  EXPECT_EQ(parse(replaced(kTrial, "rate: max", "rate: 0.5")).rate, 0.5);
  const std::string realtime = replaced(kTrial, "mode: lockstep", "mode: realtime");
  EXPECT_EQ(parse(replaced(realtime, "rate: max\n", "")).rate, 1.0);
  EXPECT_EQ(parse(replaced(realtime, "rate: max", "rate: 1")).rate, 1.0);
  EXPECT_EQ(parse(replaced(realtime, "rate: max", "rate: 1")).mode, SimMode::kRealtime);
  for (const char* rate : {"max", "2"}) {
    const std::string message =
        refusal([&] { return parse(replaced(realtime, "rate: max", "rate: " + std::string(rate))); });
    EXPECT_EQ(message,
              "trial.yaml:8: rate: expected 1, the only rate of mode realtime, found '" + std::string(rate) + "'");
  }
}

TEST(ScenarioFile, RealtimeGivesUpASilentHolderWithin20MsAndHandsOverWithin5) {
  const std::string realtime = replaced(replaced(kTrial, "mode: lockstep", "mode: realtime"), "rate: max\n", "");
  const std::string defaults = replaced(replaced(realtime, "max_missed_steps: 7\n", ""), "margin_steps: 6, ", "");
  EXPECT_EQ(parse(defaults).baton.margin_steps, 3u);
  EXPECT_EQ(parse(realtime).baton.margin_steps, 6u);
  const auto missed = [&](const std::string& step_s) {
    const std::string text = replaced(defaults, section("swaps:", "baton:"), "");
    return parse(replaced(text, "step_s: 0.0005", "step_s: " + step_s)).max_missed_steps;
  };
  EXPECT_EQ(missed("0.0005"), 20u);
  EXPECT_EQ(missed("0.001"), 19u);
  EXPECT_EQ(missed("0.004"), 4u);
  EXPECT_EQ(missed("0.01"), 1u);
  EXPECT_EQ(missed("0.1"), 1u) << "one is always forgiven";
}

TEST(ScenarioFile, AJointsEffortLimitScalesItsEffortRate) {
  const std::string without = replaced(kTrial, "max_effort_rate: [300, 200, 100], ", "");
  const Scenario s = parse(replaced(without, "start: {", "effort_limit: [87, 8.7, 1e9]\nstart: {"));
  EXPECT_NEAR(s.baton.max_effort_rate(0), 1000.0, 1e-12);
  EXPECT_NEAR(s.baton.max_effort_rate(1), 100.0, 1e-13);
  EXPECT_EQ(parse(replaced(kTrial, "[300, 200, 100]", "40")).baton.max_effort_rate, JointVector(Vector3::Constant(40)));
}

TEST(ScenarioFile, LetsTheBatonComeBackAndSwapsFollowAsCloselyAsTheyMay) {
  // margin 6: first swap from step 8, then 15 steps apart, here without a fade.
  const std::string text =
      replaced(replaced(kTrial, "blend_s: 0.15", "blend_s: 0"), section("  - {at_s: 1.0", "baton:"),
               "  - {at_s: 0.004, to: impedance}\n  - {at_s: 0.0115, to: tracking}\n");
  const Scenario s = parse(text);
  EXPECT_EQ(s.swaps[0].at_step, 8u);
  EXPECT_EQ(s.swaps[1].at_step, 23u);
  const std::string too_close = refusal([&] { return parse(replaced(text, "0.0115", "0.011")); });
  EXPECT_NE(too_close.find("swaps[1].at_s: expected a time not before step 23 (0.0115 s)"), std::string::npos)
      << too_close;
  const std::string too_early = refusal([&] { return parse(replaced(text, "0.004,", "0.0035,")); });
  EXPECT_NE(too_early.find("swaps[0].at_s: expected a time not before step 8 (0.004 s)"), std::string::npos)
      << too_early;
}

class BadScenario : public testing::TestWithParam<BadInput> {};

TEST_P(BadScenario, IsRefusedWithFileLineExpectedAndFound) {
  const BadInput& bad = GetParam();
  const std::string text = replaced(kTrial, bad.from, bad.to);
  expectMessage(refusal([&] { return parse(text); }), "trial.yaml", text, bad);
}

std::string nameOf(const testing::TestParamInfo<BadInput>& test) { return test.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Head, BadScenario,
    testing::Values(
        BadInput{"NoRobot", "robot: rpp.yaml\n", "", "name: trial", "expected the key 'robot'", "found only name"},
        BadInput{"NameWithSlash", "name: trial", "name: a/b", "a/b", "expected a name of 1 to 31", "'a/b'"},
        BadInput{"LongName", "name: trial", "name: abcdefghijabcdefghijabcdefghijab", "name: a", "1 to 31", "'abcdef"},
        BadInput{"MisspelledKey", "duration_s:", "durations_s:", "durations_s", "did you mean 'duration_s'?",
                 "'durations_s'"},
        BadInput{"KeyTwice", "substeps: 4", "robot: other.yaml", "robot: other", "each key once", "'robot'"},
        BadInput{"RobotList", "robot: rpp.yaml", "robot: [rpp.yaml]", "robot:", "expected text", "a list of 1 value"},
        BadInput{"NotYaml", "mode: lockstep", "mode: [lockstep", "rate:", "expected valid YAML", "found: "}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    Time, BadScenario,
    testing::Values(
        BadInput{"StepZero", "step_s: 0.0005", "step_s: 0", "step_s", "a number from 1e-06 to 1 s", "'0'"},
        BadInput{"StepNaN", "step_s: 0.0005", "step_s: nan", "step_s", "a number from 1e-06 to 1 s", "'nan'"},
        BadInput{"StepLong", "step_s: 0.0005", "step_s: 1.5", "step_s", "a number from 1e-06 to 1 s", "'1.5'"},
        BadInput{"StepBetweenNanoseconds", "step_s: 0.0005", "step_s: 0.0005000005", "step_s",
                 "expected a whole number of nanoseconds", "'0.0005000005'"},
        BadInput{"NoSubsteps", "substeps: 4", "substeps: 0", "substeps", "a whole number from 1 to 1000", "'0'"},
        BadInput{"HalfSubsteps", "substeps: 4", "substeps: 4.5", "substeps", "a whole number", "'4.5'"},
        BadInput{"PartOfAStep", "duration_s: 8", "duration_s: 8.0003", "duration_s",
                 "expected a whole number of steps of 0.0005 s (the nearest is 8.0005)", "'8.0003'"},
        BadInput{"DurationNextToNothing", "duration_s: 8", "duration_s: 1e-10", "duration_s",
                 "expected a whole number of steps", "'1e-10'"},
        BadInput{"NegativeDuration", "duration_s: 8", "duration_s: -1", "duration_s", "from 0 to 1000000 s", "'-1'"},
        BadInput{"UnknownMode", "mode: lockstep", "mode: lockstp", "mode", "one of lockstep, realtime", "'lockstp'"},
        BadInput{"RateZero", "rate: max", "rate: 0", "rate", "from 1e-07 to 1000 times real time, or max", "'0'"},
        BadInput{"RateWord", "rate: max", "rate: fast", "rate", "times real time, or max", "'fast'"},
        BadInput{"RateList", "rate: max", "rate: [max]", "rate", "times real time, or max", "a list of 1 value"},
        BadInput{"UnknownPolicy", "policy: fallback", "policy: hope", "late", "one of wait, fallback, abort", "'hope'"},
        BadInput{"LateAtOnce", "after_s: 12", "after_s: 0", "late", "a number above 0", "'0'"},
        BadInput{"NegativeMisses", "max_missed_steps: 7", "max_missed_steps: -1", "max_missed", "from 0 to", "'-1'"}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    World, BadScenario,
    testing::Values(
        BadInput{"StartTooShort", "position: [0.1, 0.2, 0.3]", "position: [0.1, 0.2]", "start",
                 "a list of 3 numbers, one per joint", "a list of 2 values"},
        BadInput{"StartInfinite", "velocity: [1, 2, 4]", "velocity: [1, .inf, 4]", "start", "rad/s or m/s", "'.inf'"},
        BadInput{"NoWalls", section("  walls:", "trajectory:"), "  {}\n", "environment", "expected the key 'walls'",
                 "none"},
        BadInput{"EmptyWalls", section("  walls:", "trajectory:"), "  walls: []\n", "walls", "a list of 1 to 16",
                 "list of 0"},
        BadInput{"UnknownCoupling", "coupling: late", "coupling: tight", "coupling", "one of derivatives, held, late",
                 "'tight'"},
        BadInput{"NegativeStiffness", "stiffness_N_per_m: 200", "stiffness_N_per_m: -200", "- {point_m",
                 "walls[0].stiffness_N_per_m: expected a number from 0 to 1000000000 N/m", "'-200'"},
        BadInput{"NegativeDamping", "damping_N_s_per_m: 5", "damping_N_s_per_m: -5", "- {point_m", "from 0", "'-5'"},
        BadInput{"NoNormal", "normal: [0, 0, 2]", "normal: [0, 0, 0]", "- {point_m", "expected a direction",
                 "length 0"},
        BadInput{"FlatNormal", "normal: [0, 0, 2]", "normal: 2", "- {point_m", "a list of 3 numbers", "'2'"},
        BadInput{"WallUnitForgotten", "stiffness_N_per_m", "stiffness", "- {point_m", "stiffness_N_per_m",
                 "'stiffness'"},
        BadInput{"UnknownInterpolation", "cubic", "linear", "linear", "one of quintic, cubic", "'linear'"},
        BadInput{"NoWaypoints", section("  waypoints:", "  force_N"), "  waypoints: []\n", "waypoints", "1 to 10000",
                 "a list of 0"},
        BadInput{"TimesFall", "time_s: 2", "time_s: 0", "- {time_s: 0, position: [pi",
                 "a time after the waypoint before", "'0'"},
        BadInput{"WaypointTooLong", "[pi/6, 0.25, 0.15]", "[pi/6, 0.25, 0.15, 0]", "0.15, 0]", "one per joint",
                 "a list of 4 values"},
        BadInput{"WaypointNaN", "[pi/6, 0.25, 0.15]", "[pi/6, nan, 0.15]", "nan", "a number from", "'nan'"},
        BadInput{"ForceTooShort", "force_N: [0, 0, 3]", "force_N: [0, 0]", "force_N", "a list of 3", "a list of 2"},
        BadInput{"MomentNaN", "moment_Nm: [0.5,", "moment_Nm: [.nan,", "moment_Nm", "N m", "'.nan'"}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    Controllers, BadScenario,
    testing::Values(
        BadInput{"None", section("  - name: tracking", "active:"), "  []\n", "controllers", "a list of 1 to 16",
                 "list of 0"},
        BadInput{"NameOfAService", "name: force", "name: recorder", "name: recorder", "not that of another service",
                 "'recorder'"},
        BadInput{"NameOfACommand", "name: force", "name: operator-1", "name: operator-1", "not that of another service",
                 "'operator-1'"},
        BadInput{"NameTwice", "name: force", "name: impedance", "name: impedance\n    law: force",
                 "no other controller", "'impedance'"},
        BadInput{"BadName", "name: force", "name: for ce", "for ce", "expected a name", "'for ce'"},
        BadInput{"UnknownLaw", "law: force_pi", "law: force_p", "force_p", "did you mean 'force_pi'?", "'force_p'"},
        BadInput{"ForceWithoutEnvironment", section("environment:", "trajectory:"), "", "law: impedance",
                 "expected an environment", "found none"},
        BadInput{"UnknownParameter", "solver: position", "solvr: position", "solvr", "did you mean 'solver'?",
                 "'solvr'"},
        BadInput{"ParameterSize", "kp: [280, 280, 70, 70, 70, 70]", "kp: [280, 280, 70]", "kp: [280",
                 "expected 1 or 6 numbers", "found 3 numbers"},
        BadInput{"ParameterRange", "kd: 30", "kd: -30", "kd: -30", ">= 0", "-30"},
        BadInput{"ParameterNaN", "kd: 30", "kd: .nan", "kd: .nan", "expected a number", "'.nan'"},
        BadInput{"ParameterWord", "solver: position", "solver: newton", "newton", "expected one of position",
                 "'newton'"},
        BadInput{"ParameterEmpty", "kd: 30", "kd: []", "kd: []", "expected 1 or 6 numbers", "found no number"},
        BadInput{"ParameterTwice", "kd: 30", "kp: 30", "kp: 30", "each key once", "'kp'"},
        BadInput{"UnknownActive", "active: tracking", "active: trackin", "active", "did you mean 'tracking'?",
                 "'trackin'"},
        BadInput{"UnknownStandby", "standby: cold", "standby: warm", "standby", "one of hot, cold", "'warm'"}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    Baton, BadScenario,
    testing::Values(
        BadInput{"UnknownTarget", "to: force}", "to: froce}", "froce", "did you mean 'force'?", "'froce'"},
        BadInput{"TooEarly", "at_s: 1.0", "at_s: 0.001", "at_s: 0.001", "not before step 8 (0.004 s)", "'0.001'"},
        BadInput{"AfterTheEnd", "at_s: 4.0", "at_s: 8", "at_s: 8", "before the end of the run, step 16000 (8 s)",
                 "'8'"},
        BadInput{"Backwards", "at_s: 4.0", "at_s: 0.5", "at_s: 0.5", "not before step 2300 (1.15 s)", "'0.5'"},
        BadInput{"DuringTheBlend", "at_s: 4.0", "at_s: 1.1", "at_s: 1.1", "not before step 2300 (1.15 s)", "'1.1'"},
        BadInput{"BetweenSteps", "at_s: 1.0", "at_s: 1.0002", "1.0002", "a whole number of steps", "'1.0002'"},
        BadInput{"ToItsHolder", "to: impedance}", "to: tracking}", "to: tracking", "does not hold the baton already",
                 "'tracking'"},
        BadInput{"ToTheNextHolder", "to: force}", "to: impedance}", "at_s: 4.0", "does not hold the baton already",
                 "'impedance'"},
        BadInput{"NothingUnderSwaps", section("  - {at_s: 1.0", "baton:"), "", "swaps", "([] for none)",
                 "found nothing"},
        BadInput{"NoMargin", "margin_steps: 6", "margin_steps: 0", "baton:", "from 1 to 1000", "'0'"},
        BadInput{"NegativeBlend", "blend_s: 0.15", "blend_s: -0.15", "baton:", "from 0 to 10 s", "'-0.15'"},
        BadInput{"NoEffortRate", "max_effort_rate: [300, 200, 100]", "max_effort_rate: [300, 0, 100]",
                 "baton:", "above 0", "'0'"},
        BadInput{"NoEffortStep", "max_effort_step: 40", "max_effort_step: 0", "baton:", "above 0", "'0'"},
        BadInput{"UnknownFallback", "[impedance, tracking]", "[impedence]", "baton:", "did you mean 'impedance'?",
                 "'impedence'"},
        BadInput{"FallbackTwice", "[impedance, tracking]", "[impedance, impedance]", "baton:", "each controller once",
                 "'impedance'"}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    Recording, BadScenario,
    testing::Values(
        BadInput{"Yes", "enabled: false", "enabled: yes", "recording", "true or false", "'yes'"},
        BadInput{"Zip", "compression: lz4", "compression: zip", "recording", "one of none, lz4, zstd", "'zip'"},
        BadInput{"Sync", "sync: 0.5", "sync: often", "recording", "s, or none, or chunk", "'often'"},
        BadInput{"SyncNever", "sync: 0.5", "sync: 0", "recording", "s, or none, or chunk", "'0'"},
        BadInput{"LittleCredit", "credit_steps: 64", "credit_steps: 15", "recording", "from 16 to 512", "'15'"},
        BadInput{"MuchCredit", "credit_steps: 64", "credit_steps: 513", "recording", "from 16 to 512", "'513'"}),
    nameOf);

TEST(ScenarioFile, SaysWhichControllersThereAre) {
  const Scenario s = parse(kTrial);
  EXPECT_NE(refusal([&] { return s.controller("forse"); }).find("did you mean 'force'?"), std::string::npos);
}

/// A folder of this test's own, gone when it is over.
class ScenarioFolder : public testing::Test {
 protected:
  ScenarioFolder() {
    std::filesystem::create_directories(root / "robots");
    std::filesystem::create_directories(root / "scenarios");
  }
  ~ScenarioFolder() override { std::filesystem::remove_all(root); }

  std::string write(const std::string& relative, const std::string& text) const {
    std::ofstream(root / relative) << text;
    return (root / relative).string();
  }

  const std::filesystem::path root =
      std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ScenarioFolder, FindsTheRobotRelativeToTheScenarioAndKeepsBothTexts) {
  const std::string robot_text = readYamlFile((deployFolder() / "robots/link1.yaml").string());
  write("robots/link.yaml", robot_text);
  const std::string text =
      "name: a\nrobot: ../robots/link.yaml\nstep_s: 0.001\ntrajectory: {waypoints: [{time_s: 0, position: [0]}]}\n"
      "controllers: [{name: pd, law: joint_pd}]\nactive: pd\n";
  const std::string file = write("scenarios/a.yaml", text);
  const Scenario s = loadScenario(file);
  EXPECT_EQ(s.file, std::filesystem::path(file).lexically_normal());
  EXPECT_EQ(s.text, text);
  EXPECT_EQ(s.robot_file, (root / "robots/link.yaml").lexically_normal());
  EXPECT_EQ(s.robot_text, robot_text);
  EXPECT_EQ(s.warnings.size(), 1u);  // the link is no possible body

  // What a recording keeps is enough to make the same scenario again.
  const Scenario again = parseScenario(s.file, s.text, s.robot_file, s.robot_text);
  EXPECT_EQ(again.file, s.file);
  EXPECT_EQ(again.robot_file, s.robot_file);
  EXPECT_EQ(again.robot.name, s.robot.name);
  EXPECT_EQ(again.controllers[0].parameters, s.controllers[0].parameters);
}

TEST_F(ScenarioFolder, NamesTheRobotFileThatIsMissingOrWrong) {
  const std::string file = write("scenarios/a.yaml", "name: a\nrobot: ../robots/b.yaml\n");
  const std::string robot = (root / "robots/b.yaml").lexically_normal().string();
  EXPECT_EQ(refusal([&] { return loadScenario(file); }),
            file + ":2: robot: " + robot + ": expected a file that can be read, found: No such file or directory");
  write("robots/b.yaml", "nam: b\n");
  EXPECT_EQ(refusal([&] { return loadScenario(file); }).rfind(robot + ":1: unknown key 'nam'; did you mean 'name'?", 0),
            0u);
}

TEST_F(ScenarioFolder, ThatHasNoScenarioIsNamed) {
  const std::string file = (root / "none.yaml").string();
  EXPECT_EQ(refusal([&] { return loadScenario(file); }),
            file + ": expected a file that can be read, found: No such file or directory");
}

}  // namespace
}  // namespace baton
