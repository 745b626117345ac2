#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bad_input.hpp"
#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using test::BadInput;
using test::deployFolder;
using test::refusal;
using test::replaced;

constexpr double kPi = 3.14159265358979323846;

const char* const kArm = R"(name: arm
gravity_m_per_s2: [0, 0, -9.81]
base: {a_m: 0.1, alpha_rad: pi/2, theta_rad: -pi/6, d_m: 0.3}
joints:
  - name: turn
    kind: revolute
    dh: {a_m: 0.5}
    link:
      mass_kg: 2
      com_m: [-0.25, 0, 0.01]
      inertia_com_kg_m2: {xx: 0.01, yy: 0.05, zz: 0.055, xy: 0.001, xz: -0.002, yz: 0.003}
    friction: {viscous: 0.4, coulomb: 0.5, coulomb_velocity: 0.02}
    effort_limit: 30
  - name: slide
    kind: prismatic
    dh: {alpha_rad: pi, d_m: 0.2}
    link:
      mass_kg: 1.5
      com_m: [0, 0.1, 0]
      inertia_origin_kg_m2: {xx: 0.02, yy: 0.006, zz: 0.02}
)";

TEST(RobotFile, GivesEachFieldItsPlace) {
  std::vector<std::string> warnings;
  const RobotModel arm = parseRobot("arm.yaml", kArm, &warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(arm.name, "arm");
  EXPECT_EQ(arm.gravity_W, Vector3(0.0, 0.0, -9.81));
  EXPECT_EQ(arm.base.a_m, 0.1);
  EXPECT_EQ(arm.base.alpha_rad, kPi / 2);
  EXPECT_EQ(arm.base.theta_rad, -kPi / 6);
  EXPECT_EQ(arm.base.d_m, 0.3);
  ASSERT_EQ(arm.size(), 2);

  const Joint& turn = arm.joints[0];
  EXPECT_EQ(turn.name, "turn");
  EXPECT_EQ(turn.kind, JointKind::kRevolute);
  EXPECT_EQ(turn.dh.a_m, 0.5);
  EXPECT_EQ(turn.dh.alpha_rad, 0.0);
  EXPECT_EQ(turn.link.mass_kg, 2.0);
  EXPECT_EQ(turn.link.first_moment_kg_m, Vector3(-0.5, 0.0, 0.02));
  Matrix3 inertia;
  inertia << 0.01, 0.001, -0.002, 0.001, 0.05, 0.003, -0.002, 0.003, 0.055;
  EXPECT_TRUE(turn.link.inertiaAtCentreOfMass().isApprox(inertia, 1e-14));  // there and back by parallel axes
  EXPECT_EQ(turn.friction.viscous, 0.4);
  EXPECT_EQ(turn.friction.coulomb, 0.5);
  EXPECT_EQ(turn.friction.coulomb_velocity, 0.02);
  EXPECT_EQ(turn.effort_limit, 30.0);

  const Joint& slide = arm.joints[1];
  EXPECT_EQ(slide.kind, JointKind::kPrismatic);
  EXPECT_EQ(slide.dh.alpha_rad, kPi);
  EXPECT_EQ(slide.dh.d_m, 0.2);
  EXPECT_EQ(slide.link.inertia_origin_kg_m2, Matrix3(Vector3(0.02, 0.006, 0.02).asDiagonal()));
  EXPECT_EQ(slide.friction.viscous, 0.0);
  EXPECT_EQ(slide.effort_limit, std::numeric_limits<double>::infinity());
}

class BadRobot : public testing::TestWithParam<BadInput> {};

TEST_P(BadRobot, IsRefusedWithFileLineExpectedAndFound) {
  const BadInput& bad = GetParam();
  const std::string text = replaced(kArm, bad.from, bad.to);
  expectMessage(refusal([&] { return parseRobot("arm.yaml", text); }), "arm.yaml", text, bad);
}

INSTANTIATE_TEST_SUITE_P(
    Files, BadRobot,
    testing::Values(
        BadInput{"NoName", "name: arm\n", "", "gravity", "expected the key 'name'", "found only gravity_m_per_s2"},
        BadInput{"NameWithBlank", "name: arm", "name: my arm", "my arm", "expected a name of 1 to 31", "'my arm'"},
        BadInput{"MisspelledKey", "joints:", "jonts:", "jonts:", "did you mean 'joints'?", "'jonts'"},
        BadInput{"MisspelledLinkKey", "mass_kg: 2", "mas_kg: 2", "mas_kg", "did you mean 'mass_kg'?", "'mas_kg'"},
        BadInput{"KeyTwice", "    effort_limit: 30\n", "    name: again\n", "name: again", "each key once", "'name'"},
        BadInput{"FlatGravity", "[0, 0, -9.81]", "-9.81", "-9.81", "expected a list of 3 numbers", "found '-9.81'"},
        BadInput{"GravityNaN", "-9.81", ".nan", ".nan", "expected a number from", "found '.nan'"},
        BadInput{"NoJoints", kArm + std::string(kArm).find("  - name: turn"), "  []\n",
                 "joints:", "expected a list of 1 to 8", "found a list of 0"},
        BadInput{"UnknownKind", "revolute", "rotary", "rotary", "one of revolute, prismatic", "'rotary'"},
        BadInput{"AngleInDegrees", "alpha_rad: pi,", "alpha_rad: 180,", "180", "from -100 to 100 rad", "'180'"},
        BadInput{"InfiniteLength", "d_m: 0.2", "d_m: .inf", ".inf", "expected a number from -100 to 100 m", "'.inf'"},
        BadInput{"WordForMass", "mass_kg: 1.5", "mass_kg: heavy", "heavy", "expected a number", "'heavy'"},
        BadInput{"NoCentreOfMass", "      com_m: [0, 0.1, 0]\n", "", "link:\n      mass_kg: 1.5", "the key 'com_m'",
                 "found only mass_kg"},
        BadInput{"PlaneCentreOfMass", "[0, 0.1, 0]", "[0, 0.1]", "[0, 0.1]", "a list of 3 numbers", "a list of 2"},
        BadInput{"InertiaIsNoNumber", "inertia_origin_kg_m2: {xx: 0.02, yy: 0.006, zz: 0.02}",
                 "inertia_origin_kg_m2: {xx: 0.02, yy: 0.006, zz: abc}", "abc", "expected a number", "'abc'"},
        BadInput{"InertiaIsNotFinite", "inertia_origin_kg_m2: {xx: 0.02, yy: 0.006, zz: 0.02}",
                 "inertia_origin_kg_m2: {xx: .nan, yy: 0.006, zz: 0.02}", ".nan", "expected a number", "'.nan'"},
        BadInput{"InertiaIsTooLarge", "inertia_origin_kg_m2: {xx: 0.02, yy: 0.006, zz: 0.02}",
                 "inertia_origin_kg_m2: {xx: 0.02, yy: 1e300, zz: 0.02}", "1e300", "expected a number", "'1e300'"},
        BadInput{"NoInertia", "      inertia_origin_kg_m2: {xx: 0.02, yy: 0.006, zz: 0.02}\n", "",
                 "link:\n      mass_kg: 1.5", "expected either inertia_com_kg_m2", "found neither"},
        BadInput{"TwoInertias", "      inertia_origin", "      inertia_com_kg_m2: {}\n      inertia_origin",
                 "link:\n      mass_kg: 1.5", "expected either inertia_com_kg_m2", "found both"},
        BadInput{"UnknownInertia", "xy: 0.001", "yx: 0.001", "yx:", "unknown key", "'yx'"},
        BadInput{"NegativeFriction", "viscous: 0.4", "viscous: -0.4", "-0.4", "expected a number from 0", "'-0.4'"},
        BadInput{"NoCoulombVelocity", "coulomb_velocity: 0.02", "coulomb_velocity: 0", "coulomb_velocity",
                 "expected a number from 1e-09", "'0'"},
        BadInput{"NoEffort", "effort_limit: 30", "effort_limit: 0", "effort_limit", "expected a number above 0", "'0'"},
        BadInput{"SameNameTwice", "name: slide", "name: turn", "- name: turn\n    kind: prismatic",
                 "a name of its own for each joint", "a second 'turn'"},
        BadInput{"NoMassMatrix", "mass_kg: 1.5", "mass_kg: -1.5", "joints:", "mass matrix is not positive definite",
                 "robot 'arm'"}),
    [](const auto& test) { return test.param.name; });

TEST(RobotFile, WarnsOfAnImpossibleBodyAndAcceptsIt) {
  std::vector<std::string> warnings;
  const std::string text = replaced(kArm, "{xx: 0.02, yy: 0.006, zz: 0.02}", "{xx: 0.02, yy: 0.006, zz: 0.9}");
  EXPECT_EQ(parseRobot("arm.yaml", text, &warnings).size(), 2);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].rfind("arm.yaml:4: joints: ", 0), 0u) << warnings[0];
  EXPECT_NE(warnings[0].find("'slide'"), std::string::npos) << warnings[0];
}

TEST(RobotFile, MayHaveEightJointsAndNoMore) {
  const std::string head = "name: chain\ngravity_m_per_s2: [0, 0, 0]\njoints:\n";
  const auto chain = [&](int n) {
    std::string text = head;
    for (int i = 1; i <= n; ++i) {
      text += "  - name: j" + std::to_string(i) +
              "\n    kind: prismatic\n    dh: {alpha_rad: 1, a_m: 0.1}\n"
              "    link: {mass_kg: 1, com_m: [0, 0, 0], inertia_com_kg_m2: {xx: 1, yy: 1, zz: 1}}\n";
    }
    return text;
  };
  EXPECT_EQ(refusal([&] { return parseRobot("chain.yaml", chain(9)); }),
            "chain.yaml:3: joints: expected a list of 1 to 8 values, found a list of 9 values");
  // Eight sliding joints in three dimensions still have a mass matrix of full rank: each carries a mass of its own.
  EXPECT_EQ(parseRobot("chain.yaml", chain(8)).size(), 8);
}

TEST(RobotFile, ThatIsNotThereIsNamed) {
  EXPECT_EQ(refusal([] { return loadRobot("nowhere/arm.yaml"); }),
            "nowhere/arm.yaml: expected a file that can be read, found: No such file or directory");
}

// Two independent writings of one robot: the file, and the program text that the mathematics is tested with. 1e-9 is
// far below the digits the report prints and above the decimals to which the file rounds a cylinder's inertia.
void expectSameRobot(const RobotModel& a, const RobotModel& b) {
  ASSERT_EQ(a.size(), b.size());
  std::mt19937 generator(7);
  for (int trial = 0; trial < 20; ++trial) {
    const JointVector q = test::randomJointVector(generator, a.size(), 1.0);
    const JointVector qd = test::randomJointVector(generator, a.size(), 1.0);
    EXPECT_TRUE(tipPose(a, q).p.isApprox(tipPose(b, q).p, 1e-14));
    EXPECT_TRUE((tipPose(a, q).R - tipPose(b, q).R).isZero(1e-14));
    JointMatrix B_a, B_b;
    massMatrix(a, q, B_a);
    massMatrix(b, q, B_b);
    EXPECT_TRUE(B_a.isApprox(B_b, 1e-9));
    JointVector n_a, n_b, f_a, f_b;
    biasEffort(a, q, qd, n_a);
    biasEffort(b, q, qd, n_b);
    EXPECT_TRUE(n_a.isApprox(n_b, 1e-9));
    frictionEffort(a, qd, f_a);
    frictionEffort(b, qd, f_b);
    EXPECT_EQ(f_a, f_b);
  }
}

TEST(DeployedRpp, IsTheArmOfTheReport) {
  std::vector<std::string> warnings;
  const RobotModel arm = loadRobot((deployFolder() / "robots/rpp.yaml").string(), &warnings);
  EXPECT_TRUE(warnings.empty());
  expectSameRobot(arm, test::rppRobot());
}

TEST(DeployedRpp, ReproducesThePrintedDigits) {
  const RobotModel arm = loadRobot((deployFolder() / "robots/rpp.yaml").string());
  const JointVector q = Vector3(kPi / 3.0, 0.1, 0.1);
  JointMatrix B;
  JointVector g;
  massMatrix(arm, q, B);
  gravityEffort(arm, q, g);
  constexpr double kHalfDigit = 0.5e-4;  // of the four decimals printed
  EXPECT_TRUE((tipPose(arm, q).p - Vector3(0.3250, -0.5600, 0.9629)).isZero(kHalfDigit));
  EXPECT_TRUE((B - JointMatrix(Vector3(0.3425, 1.1583, 0.0405).asDiagonal())).isZero(kHalfDigit));
  EXPECT_TRUE((g - Vector3(2.3767, 0.0, 0.3439)).isZero(kHalfDigit));
  EXPECT_NEAR(B(0, 0), 0.3425, 1e-12);  // made exact by link 1's lumped inertia
}

TEST(DeployedLink1, IsThePendulumOfTheReportAndWarnsThatItIsNoBody) {
  std::vector<std::string> warnings;
  const RobotModel link = loadRobot((deployFolder() / "robots/link1.yaml").string(), &warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("'pivot'"), std::string::npos) << warnings[0];
  expectSameRobot(link, test::link1Robot());

  // I qdd + F qd + m g d sin(q) = tau, term by term.
  const JointVector q = JointVector::Constant(1, 0.7), qd = JointVector::Constant(1, 2.0);
  JointMatrix B;
  JointVector g, friction;
  massMatrix(link, q, B);
  gravityEffort(link, q, g);
  frictionEffort(link, qd, friction);
  EXPECT_NEAR(B(0, 0), 0.1, 1e-12);
  EXPECT_NEAR(g(0), 11.4345 * 9.806 * 1.75 * std::sin(0.7), 1e-12 * 200.0);
  EXPECT_NEAR(friction(0), 0.4, 1e-15);
}

}  // namespace
}  // namespace baton
