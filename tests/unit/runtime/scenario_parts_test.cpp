/// The parts of a scenario that scenario_parts.cpp reads: walls, trajectories, noise; and what the whole makes of them.
#include "runtime/scenario_parts.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <sstream>

#include "bad_input.hpp"
#include "robot/kinematics.hpp"
#include "robot/simulation.hpp"
#include "runtime/monolithic_run.hpp"
#include "runtime/scenario.hpp"

namespace baton {
namespace {

using test::BadInput;
using test::refusal;
using test::replaced;
using test::rppScenario;

constexpr double kPi = 3.14159265358979323846;

const std::string kHead = R"(name: parts
robot: rpp.yaml
step_s: 0.001
start: {position: [pi/6, 0.2, 0.1]}
environment: {walls: [{point_m: [0, 0, 0.7], normal: [0, 0, 1], stiffness_N_per_m: 0}]}
controllers: [{name: tip, law: operational_inverse_dynamics}]
active: tip
)";

const std::string kTip = kHead + R"(trajectory:
  interpolation: trapezoidal
  ramp: 0.2
  waypoints:
    - {time_s: 0, tip_m: [0.55, -0.46, 0.4]}
    - {time_s: 2, tip_m: [0.5629, -0.66, 0.725], tip_zyz_rad: [pi/5, pi/3, pi/2]}
    - {time_s: 3, tip_m: [0.5, -0.6, 0.7]}
)";

const std::string kSine = kHead + R"(trajectory:
  sine:
    amplitude: [pi/3, 0.05, 0.1]
    frequency_rad_per_s: 2
    phase_rad: [0, pi/2, 0]
    offset: 0.25
    end_s: 18
    slow_down_s: 2
  noise:
    hold_s: 0.1
    standard_deviation: [0.1, 0.02, 0.03]
    seed: 7
)";

Scenario parse(const std::string& text) { return rppScenario("parts.yaml", text); }

TEST(ScenarioTrajectory, ReadsWaypointsOfTheTip) {
  const Scenario s = parse(kTip);
  const auto& tip = std::get<TipPath>(s.trajectory.motion);
  EXPECT_EQ(tip.timing.interpolation, Interpolation::kTrapezoidal);
  EXPECT_EQ(tip.timing.ramp, 0.2);
  ASSERT_EQ(tip.waypoints.size(), 3u);
  EXPECT_EQ(tip.waypoints[1].time_s, 2.0);
  EXPECT_EQ(tip.waypoints[1].X_WE.p, Vector3(0.5629, -0.66, 0.725));
  // ZYZ there and back by the robot's own formula.
  EXPECT_TRUE(zyzFromRotation(tip.waypoints[1].X_WE.R).isApprox(Vector3(kPi / 5, kPi / 3, kPi / 2), 1e-14));
  // Left out: at the first as the arm starts, later as at the waypoint before.
  EXPECT_EQ(tip.waypoints[0].X_WE.R, tipPose(s.robot, s.start_q).R);
  EXPECT_EQ(tip.waypoints[2].X_WE.R, tip.waypoints[1].X_WE.R);
}

TEST(ScenarioTrajectory, ReadsASineAndNoise) {
  const Scenario s = parse(kSine);
  const auto& sine = std::get<JointSine>(s.trajectory.motion);
  EXPECT_EQ(sine.amplitude, JointVector(Vector3(kPi / 3, 0.05, 0.1)));
  EXPECT_EQ(sine.frequency_rad_per_s, JointVector(Vector3::Constant(2.0)));
  EXPECT_EQ(sine.phase_rad, JointVector(Vector3(0.0, kPi / 2, 0.0)));
  EXPECT_EQ(sine.offset, JointVector(Vector3::Constant(0.25)));
  EXPECT_EQ(sine.end_s, 18.0);
  EXPECT_EQ(sine.slow_down_s, 2.0);
  ASSERT_TRUE(s.trajectory.noise.has_value());
  EXPECT_EQ(s.trajectory.noise->hold_s, 0.1);
  EXPECT_EQ(s.trajectory.noise->standard_deviation, JointVector(Vector3(0.1, 0.02, 0.03)));
  EXPECT_EQ(s.trajectory.noise->seed, 7u);
}

TEST(ScenarioTrajectory, NeedsOfASineOnlyAmplitudeAndFrequency) {
  const Scenario s = parse(kHead + "trajectory: {sine: {amplitude: 0.1, frequency_rad_per_s: 1}}\n");
  const auto& sine = std::get<JointSine>(s.trajectory.motion);
  EXPECT_EQ(sine.phase_rad, JointVector(Vector3::Zero()));
  EXPECT_EQ(sine.offset, JointVector(Vector3::Zero()));
  EXPECT_EQ(sine.end_s, JointSine{}.end_s);
}

TEST(ScenarioWalls, AreAnyNumberUpTo16AndOneOrTwoSided) {
  const std::string wall = "{point_m: [0, 0.1, 0], normal: [0, 1, 0], stiffness_N_per_m: 50, unilateral: false}";
  std::string walls = wall;
  for (int i = 1; i < 16; ++i) walls += ", " + wall;
  const std::string given = "{point_m: [0, 0, 0.7], normal: [0, 0, 1], stiffness_N_per_m: 0}";
  const Scenario s = parse(replaced(kTip, given, walls));
  ASSERT_EQ(s.walls.size(), 16u);
  EXPECT_FALSE(s.walls[15].unilateral);
  EXPECT_NE(refusal([&] { return parse(replaced(kTip, given, walls + ", " + wall)); }).find("a list of 1 to 16 values"),
            std::string::npos);
}

TEST(ScenarioRobot, TakesTheLimitsOfItsActuatorsFromTheScenario) {
  EXPECT_EQ(parse(kTip).robot.joints[0].effort_limit, std::numeric_limits<double>::infinity());
  const Scenario s = parse(kTip + "effort_limit: [20, 10, 1]\n");
  EXPECT_EQ(s.robot.joints[0].effort_limit, 20.0);
  EXPECT_EQ(s.robot.joints[1].effort_limit, 10.0);
  EXPECT_EQ(s.robot.joints[2].effort_limit, 1.0);
  EXPECT_EQ(parse(kTip + "effort_limit: 5\n").robot.joints[2].effort_limit, 5.0);
}

class BadPart : public testing::TestWithParam<BadInput> {};

TEST_P(BadPart, IsRefusedWithFileLineExpectedAndFound) {
  const BadInput& bad = GetParam();
  const std::string& good = kTip.find(bad.from) != std::string::npos ? kTip : kSine;
  const std::string text = replaced(good, bad.from, bad.to);
  expectMessage(refusal([&] { return parse(text); }), "parts.yaml", text, bad);
}

std::string nameOf(const testing::TestParamInfo<BadInput>& test) { return test.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Tip, BadPart,
    testing::Values(
        BadInput{"JointLaw", "operational_inverse_dynamics", "joint_pd", "joint_pd",
                 "expected a law that follows the tip", "found joint_pd, which follows joints"},
        BadInput{"BothKinds", "0, tip_m:", "0, position: [0, 0, 0], tip_m:", "- {time_s: 0", "either a position",
                 "found both"},
        BadInput{"NeitherKind", ", tip_m: [0.55, -0.46, 0.4]", "", "- {time_s: 0", "either a position",
                 "found neither"},
        BadInput{"MixedKinds", "tip_m: [0.5, -0.6, 0.7]", "position: [0, 0, 0]", "- {time_s: 3", "of one kind",
                 "found both kinds"},
        BadInput{"TurnOfJoints", "tip_m: [0.5629, -0.66, 0.725],", "position: [0, 0, 0],", "- {time_s: 2",
                 "expected tip_m beside it", "a position of the joints"},
        BadInput{"TimesFall", "time_s: 3", "time_s: 2", "- {time_s: 2, tip_m: [0.5,", "a time after the waypoint",
                 "'2'"},
        BadInput{"FlatTip", "[0.55, -0.46, 0.4]", "[0.55, -0.46]", "- {time_s: 0", "a list of 3", "a list of 2"},
        BadInput{"Degrees", "tip_zyz_rad: [pi/5", "tip_zyz_rad: [180", "- {time_s: 2", "from -100 to 100 rad", "'180'"},
        BadInput{"UnitForgotten", "tip_zyz_rad", "tip_zyz", "- {time_s: 2",
                 "did you mean 'tip_zyz_rad'? Known: time_s, position, tip_m, tip_zyz_rad", "'tip_zyz'"},
        BadInput{"LongRamp", "ramp: 0.2", "ramp: 0.6", "ramp:", "above 0 and up to 0.5", "'0.6'"},
        BadInput{"NoRamp", "ramp: 0.2", "ramp: 0", "ramp:", "above 0 and up to 0.5", "'0'"},
        BadInput{"RampOfQuintic", "trapezoidal", "quintic", "ramp:", "interpolation: trapezoidal", "found another"},
        BadInput{"NoTimeBetween", "{time_s: 0, tip_m", "{time_s: 1.9999999999, tip_m",
                 "waypoints:", "waypoint 2: expected at least", "s after the waypoint before, found 1e-10 s"},
        BadInput{"RampOfNoTime", "ramp: 0.2", "ramp: 1e-300", "waypoints:", "waypoint 2: expected at least",
                 "found 2 s"},
        BadInput{"NoiseOnTheTip", "  ramp: 0.2\n", "  noise: {hold_s: 0.1, standard_deviation: 0.1}\n",
                 "noise:", "a motion of joints", "one of the tip"},
        BadInput{"NoWaypoints", kTip.substr(kTip.find("  waypoints:")), "", "trajectory:", "either waypoints or sine",
                 "found neither"},
        BadInput{"FlatNormal", "normal: [0, 0, 1]", "normal: [0, 0, 0]",
                 "environment:", "walls[0]: normal: expected a direction", "length 0"},
        BadInput{"SidedByNumber", "stiffness_N_per_m: 0", "stiffness_N_per_m: 0, unilateral: 1",
                 "environment:", "true or false", "'1'"}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    Sine, BadPart,
    testing::Values(
        BadInput{"AndWaypoints", "  sine:\n", "  waypoints: [{time_s: 0, position: [0, 0, 0]}]\n  sine:\n",
                 "trajectory:", "either waypoints or sine", "found both"},
        BadInput{"WithInterpolation", "  sine:\n", "  interpolation: cubic\n  sine:\n", "interpolation",
                 "expected waypoints beside it", "found a sine"},
        BadInput{"NoAmplitude", "    amplitude: [pi/3, 0.05, 0.1]\n", "", "sine:", "expected the key 'amplitude'",
                 "found only frequency_rad_per_s"},
        BadInput{"ShortAmplitude", "[pi/3, 0.05, 0.1]", "[pi/3]", "amplitude", "one per joint", "a list of 1"},
        BadInput{"NegativeFrequency", "frequency_rad_per_s: 2", "frequency_rad_per_s: -2", "frequency",
                 "from 0 to 100000 rad/s", "'-2'"},
        BadInput{"Hertz", "frequency_rad_per_s", "frequency_Hz", "frequency_Hz", "frequency_rad_per_s",
                 "'frequency_Hz'"},
        BadInput{"EndTooSoon", "end_s: 18", "end_s: 1", "sine:", "an end not before the time to slow down, 2 s",
                 "found 1 s"},
        BadInput{"SlowDownWithoutEnd", "    end_s: 18\n", "", "slow_down_s", "expected end_s beside it", "found none"},
        BadInput{"TooSharp", "frequency_rad_per_s: 2", "frequency_rad_per_s: 100000",
                 "sine:", "expected an acceleration of at most 1e+09", "found 1.0472e+10, from amplitude"},
        BadInput{"SlowDownAtOnce", "slow_down_s: 2", "slow_down_s: 1e-300",
                 "sine:", "expected an acceleration of at most 1e+09", "or the time to slow down"},
        BadInput{"NoHold", "hold_s: 0.1", "hold_s: 0", "hold_s", "from 1e-06", "'0'"},
        BadInput{"NegativeDeviation", "0.02, 0.03]", "-0.02, 0.03]", "standard_deviation", "from 0 to", "'-0.02'"},
        BadInput{"NegativeSeed", "seed: 7", "seed: -7", "seed", "a whole number from 0", "'-7'"},
        BadInput{"HalfSeed", "seed: 7", "seed: 7.5", "seed", "a whole number", "'7.5'"},
        BadInput{"NoEffort", "active: tip", "active: tip\neffort_limit: [1, 0, 1]", "effort_limit", "above 0", "'0'"}),
    nameOf);

/// A bob of 2 kg on a level slide with Coulomb friction, as a robot file and as a model.
const std::string kSlider = R"(name: slider
gravity_m_per_s2: [0, 0, -9.806]
base: {alpha_rad: pi/2}
joints:
  - name: slide
    kind: prismatic
    dh: {}
    link: {mass_kg: 2, com_m: [0, 0, 0], inertia_com_kg_m2: {}}
    friction: {coulomb: 4, coulomb_velocity: 0.001}
)";

/// Velocity after a second of a constant effort.
double velocityUnder(double effort, double step_s, const RobotModel& robot) {
  JointVector q = JointVector::Zero(1), qd = JointVector::Constant(1, 1e-4);
  const JointVector tau = JointVector::Constant(1, effort);
  const int steps = static_cast<int>(1.0 / step_s);
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(integrateStep(robot, tau, {}, step_s, 1, q, qd));
  return qd(0);
}

TEST(Friction, CreepsUnderALoadItCouldHoldAtTheDocumentedRate) {
  const RobotModel robot = parseRobot("slider.yaml", kSlider);
  for (const double part : {-0.9, 0.1, 0.5}) {
    EXPECT_NEAR(velocityUnder(part * 4.0, 1e-4, robot), 1e-3 * std::atanh(part), 1e-12) << part;
  }
  EXPECT_NEAR(std::atanh(0.5), 0.55, 5e-3);               // the figure that the robot file names
  EXPECT_GT(velocityUnder(1.1 * 4.0, 1e-4, robot), 0.1);  // a load that it cannot hold runs away
}

TEST(Friction, ThatSubstepsCannotFollowIsWarnedOfAndChatters) {
  // D / B = 4 / 0.001 / 2 = 2000 1/s: RK4 holds it up to a step of 2.785 / 2000 = 1.39 ms.
  const RobotModel robot = parseRobot("slider.yaml", kSlider);
  EXPECT_LT(std::abs(velocityUnder(0.0, 0.00125, robot)), 1e-12);
  EXPECT_GT(std::abs(velocityUnder(0.0, 0.00160, robot)), 1e-4);

  const auto warnings = [](const std::string& timing) {
    const std::string text = "name: a\nrobot: slider.yaml\n" + timing +
                             "\ncontrollers: [{name: pd, law: joint_pd}]\nactive: pd\n"
                             "trajectory: {waypoints: [{time_s: 0, position: [0]}]}\n";
    return parseScenario("a.yaml", text, "slider.yaml", kSlider).warnings;
  };
  EXPECT_TRUE(warnings("step_s: 0.00125").empty());
  EXPECT_TRUE(warnings("step_s: 0.0016\nsubsteps: 2").empty());
  const std::vector<std::string> given = warnings("step_s: 0.0016");
  ASSERT_EQ(given.size(), 1u);
  EXPECT_EQ(given[0],
            "a.yaml:3: step_s: joint friction makes a pole at 2000 1/s near rest, too fast for the plant's sub-steps; "
            "give substeps: 2, or a larger coulomb_velocity in the robot file");
  EXPECT_TRUE(parse(kTip).warnings.empty());
  // One more sub-step than is allowed: a shorter step, and of the scenario's times each falls on one of its steps.
  EXPECT_TRUE(warnings("step_s: 0.5\nsubsteps: 360").empty());
  EXPECT_NE(warnings("step_s: 0.5\nsubsteps: 350").at(0).find("; give substeps: 360, or"), std::string::npos);
}

/// The first number that follows the words.
double numberAfter(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  EXPECT_NE(at, std::string::npos) << words << " in " << text;
  return at == std::string::npos ? 0.0 : std::stod(text.substr(at + words.size()));
}

/// The slider as it is to be, with friction and a spring that holds it: what a scenario of it is warned of, and how it
/// ends.
struct Plan {
  double mass, coulomb, stiffness;
};
struct Slide {
  Slide(double step_s, double substeps, const Plan& plan, double duration_s = 0.02) {
    const auto shown = [](double number) {
      std::ostringstream text;
      text.precision(12);
      text << number;
      return text.str();
    };
    const std::string robot = replaced(replaced(kSlider, "coulomb: 4", "coulomb: " + shown(plan.coulomb)), "mass_kg: 2",
                                       "mass_kg: " + shown(plan.mass));
    std::ostringstream text;
    text << "name: a\nrobot: slider.yaml\nstep_s: " << shown(step_s) << "\nsubsteps: " << shown(substeps)
         << "\nduration_s: " << shown(duration_s) << "\nstart: {position: [0.01]}\n"
         << "environment: {walls: [{point_m: [0, 0, 0], normal: [0, -1, 0], unilateral: false, stiffness_N_per_m: "
         << shown(plan.stiffness) << "}]}\n"
         << "controllers: [{name: pd, law: joint_pd, parameters: {kp: 1, kd: 0}}]\nactive: pd\n"
         << "trajectory: {waypoints: [{time_s: 0, position: [0.01]}]}\n";
    MonolithicRun run(parseScenario("a.yaml", text.str(), "slider.yaml", robot));
    warnings = run.scenario().warnings;
    while (run.step()) {
    }
    failure = run.failure();
  }
  std::vector<std::string> warnings;
  std::string failure;
};

TEST(Stiffness, AWallThatSubstepsCannotFollowIsWarnedOfAndToBlame) {
  // sqrt(K / B) = sqrt(1e9 / 2) = 22361 1/s on the imaginary axis: RK4 holds it up to 2.828 / 22361 = 126 us.
  const Plan plan{.mass = 2.0, .coulomb = 0.0, .stiffness = 1e9};
  EXPECT_TRUE(Slide(0.001, 8, plan).warnings.empty());
  EXPECT_EQ(Slide(0.001, 8, plan).failure, "");
  const Slide few(0.001, 2, plan, 0.1);
  ASSERT_EQ(few.warnings.size(), 1u);
  EXPECT_EQ(few.warnings[0],
            "a.yaml:3: step_s: wall 1 makes a pole at 22360.7 1/s where the tip touches it, too fast for the plant's "
            "sub-steps; give substeps: 8, or a softer wall");
  EXPECT_EQ(few.failure,
            "the motion has run away: wall 1 makes a pole at 22360.7 1/s where the tip touches it, too fast for "
            "the plant's sub-steps; give substeps: 8");
}

TEST(Stiffness, AdviceCanBeFollowed) {
  // Poles that need more than the most sub-steps, of friction, of a spring, and of both.
  for (const Plan& plan : {Plan{2.0, 4e4, 0.0}, Plan{1e-6, 0.0, 1e9}, Plan{1e-6, 0.02, 1e9}}) {
    for (const double step_s : {0.001, 0.0005}) {
      const Slide slide(step_s, 4, plan);
      ASSERT_EQ(slide.warnings.size(), 1u);
      const double substeps = numberAfter(slide.warnings[0], "give substeps: ");
      const double shorter_s = numberAfter(slide.warnings[0], " and step_s: ");
      EXPECT_LE(substeps, 1000);
      EXPECT_LT(shorter_s, step_s);
      const Slide followed(shorter_s, substeps, plan);
      EXPECT_TRUE(followed.warnings.empty()) << slide.warnings[0];
      EXPECT_EQ(followed.failure, "") << slide.warnings[0];
    }
  }
}

TEST(Stiffness, WhereNothingWouldDoThatIsSaid) {
  const Slide slide(0.001, 4, {.mass = 2e-3, .coulomb = 1e6, .stiffness = 0.0});
  ASSERT_EQ(slide.warnings.size(), 1u);
  EXPECT_EQ(slide.warnings[0].find("give substeps"), std::string::npos);
  EXPECT_NE(slide.warnings[0].find("would do: give a larger coulomb_velocity"), std::string::npos) << slide.warnings[0];
}

TEST(Stiffness, FrictionOfEitherKindHasItsOwnAdvice) {
  // 2000 1/s each, where a step of 1.39 ms is the longest.
  const auto warning = [](const std::string& friction) {
    const std::string robot = replaced(kSlider, "coulomb: 4, coulomb_velocity: 0.001", friction);
    const std::string text =
        "name: a\nrobot: slider.yaml\nstep_s: 0.0016\ncontrollers: [{name: pd, law: joint_pd}]\nactive: pd\n"
        "trajectory: {waypoints: [{time_s: 0, position: [0]}]}\n";
    return parseScenario("a.yaml", text, "slider.yaml", robot).warnings.at(0);
  };
  EXPECT_EQ(
      warning("viscous: 4000, coulomb: 0.5, coulomb_velocity: 100"),
      "a.yaml:3: step_s: viscous joint friction makes a pole at 2000 1/s, too fast for the plant's sub-steps; give "
      "substeps: 2, or less viscous friction in the robot file");
  EXPECT_NE(warning("viscous: 40, coulomb: 4").find(", or a larger coulomb_velocity in the robot"), std::string::npos);
  EXPECT_NE(warning("viscous: 4000, coulomb: 4").find("coulomb_velocity and less viscous friction in the robot"),
            std::string::npos);
}

TEST(Stiffness, OnlyALawThatIsAloneIsToBlame) {
  const auto lost = [](Coupling coupling, bool is_touching) {
    Scenario scenario;
    scenario.coupling = coupling;
    Contact contact;
    contact.penetration = is_touching ? 0.1 : 0.0;
    return scenario.lostMotion(contact, false);
  };
  EXPECT_EQ(lost(Coupling::kDerivatives, false),
            "the motion has run away: the step may be too long for the law's gains");
  EXPECT_NE(lost(Coupling::kDerivatives, true).find("wall's stiffness"), std::string::npos);
  EXPECT_NE(lost(Coupling::kHeld, true).find("coupling keeps"), std::string::npos);
}

TEST(Stiffness, AContactThatMovesTheArmBeyondAllRangeIsNamed) {
  const Scenario scenario = parse(kTip);
  Contact contact;
  contact.h_e(2) = -1e9;
  Arm arm(scenario.robot, scenario.armConfig());
  const JointVector tau = JointVector::Zero(3);
  EXPECT_FALSE(arm.move(tau, contact)) << "at once: its state would be " << arm.state().qd.transpose();
  EXPECT_EQ(scenario.lostMotion(contact, Arm(arm).move(tau, {})),
            "the motion has run away: the contact that the environment sent pushes with 1e+09 N, where the tip "
            "touches nothing");
}

}  // namespace
}  // namespace baton
