#include "robot/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "base/error.hpp"
#include "support/robots.hpp"
#include "support/rpp_closed_form.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string refusal(const RobotModel& model) {
  try {
    (void)checkModel(model);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

std::string refusalAfter(const std::function<void(RobotModel&)>& spoil) {
  RobotModel model = test::rppRobot();
  spoil(model);
  return refusal(model);
}

TEST(Angle, KeepsItsValueAndItsSineAndCosine) {
  const Angle angle = 0.7;
  EXPECT_EQ(angle, 0.7);
  EXPECT_EQ(angle.sine(), std::sin(0.7));
  EXPECT_EQ(angle.cosine(), std::cos(0.7));
}

TEST(Angle, MakesQuarterTurnsExact) {
  for (int k = -4; k <= 4; ++k) {
    const Angle angle = k * kPi / 2;
    const double expected_sine = k % 2 == 0 ? 0.0 : (k == 1 || k == -3 ? 1.0 : -1.0);
    const double expected_cosine = k % 2 != 0 ? 0.0 : (k % 4 == 0 ? 1.0 : -1.0);
    EXPECT_EQ(angle.sine(), expected_sine) << k;
    EXPECT_EQ(angle.cosine(), expected_cosine) << k;
  }
}

TEST(LinkInertia, MovesInertiaByParallelAxesOnceAndBack) {
  Matrix3 inertia_com;
  inertia_com << 0.3, 0.01, -0.02,  //
      0.01, 0.4, 0.03,              //
      -0.02, 0.03, 0.5;
  const Vector3 com(0.1, -0.2, 0.3);
  const LinkInertia link = LinkInertia::fromCentreOfMass(2.0, com, inertia_com);
  EXPECT_EQ(link.mass_kg, 2.0);
  EXPECT_TRUE(link.first_moment_kg_m.isApprox(2.0 * com));
  // Steiner by hand: I_xx + m (y^2 + z^2), I_xy - m x y.
  EXPECT_NEAR(link.inertia_origin_kg_m2(0, 0), 0.3 + 2.0 * (0.04 + 0.09), 1e-15);
  EXPECT_NEAR(link.inertia_origin_kg_m2(0, 1), 0.01 + 2.0 * 0.1 * 0.2, 1e-15);
  EXPECT_TRUE(link.centreOfMass().isApprox(com, 1e-14));
  EXPECT_TRUE(link.inertiaAtCentreOfMass().isApprox(inertia_com, 1e-14));
}

TEST(LinkInertia, HasItsCentreAtTheOriginWhenMassless) {
  EXPECT_EQ(LinkInertia{}.centreOfMass(), Vector3::Zero());
  EXPECT_EQ(LinkInertia{}.inertiaAtCentreOfMass(), Matrix3::Zero());
}

TEST(CheckModel, AcceptsSoundRobotsWithoutAWord) {
  EXPECT_TRUE(checkModel(test::rppRobot()).empty());
  for (int n = 1; n <= kMaxJoints; ++n) EXPECT_TRUE(checkModel(test::randomChain(n, n)).empty()) << n;
}

TEST(CheckModel, WarnsOfAnImpossibleBodyByNameAndAcceptsIt) {
  const std::vector<std::string> warnings = checkModel(test::link1Robot());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("joint 1 'pivot'"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("not a possible rigid body"), std::string::npos) << warnings[0];
}

TEST(CheckModel, WarnsOfANegativeMassThatOthersMakeUpFor) {
  RobotModel model = test::rppRobot();
  model.joints[0].link.mass_kg = -0.01;
  model.joints[0].link.first_moment_kg_m.setZero();
  EXPECT_EQ(checkModel(model).size(), 1u);
}

TEST(CheckModel, AcceptsAMasslessLinkBetweenOthers) {
  RobotModel model = test::rppRobot();
  model.joints[1].link = LinkInertia{};
  EXPECT_TRUE(checkModel(model).empty());
}

TEST(CheckModel, RefusesAWrongNumberOfJoints) {
  EXPECT_NE(refusal(RobotModel{}).find("1 to 8 joints, found 0"), std::string::npos);
  RobotModel long_chain = test::randomChain(kMaxJoints, 1);
  long_chain.joints.push_back(long_chain.joints.back());
  EXPECT_NE(refusal(long_chain).find("found 9"), std::string::npos);
}

TEST(CheckModel, RefusesNumbersThatAreNotFiniteAndNamesTheJoint) {
  const auto names = [](const std::string& message) { return message.find("joint 2 'slide'") != std::string::npos; };
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[1].dh.alpha_rad = kNan; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[1].dh.d_m = kInfinity; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[1].link.mass_kg = kNan; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[1].link.first_moment_kg_m.y() = kNan; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[1].link.inertia_origin_kg_m2(2, 1) = kInfinity; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[1].effort_limit = kNan; })));
  EXPECT_NE(refusalAfter([](RobotModel& m) { m.base.a_m = kNan; }), "");
  EXPECT_NE(refusalAfter([](RobotModel& m) { m.gravity_W.x() = kNan; }), "");
}

TEST(CheckModel, RefusesNegativeFrictionAndLimitsAndNamesTheJoint) {
  const auto names = [](const std::string& message) { return message.find("joint 3 'reach'") != std::string::npos; };
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[2].friction.viscous = -0.1; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[2].friction.coulomb = -0.1; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[2].friction.coulomb_velocity = 0.0; })));
  EXPECT_TRUE(names(refusalAfter([](RobotModel& m) { m.joints[2].effort_limit = -1.0; })));
}

TEST(CheckModel, RefusesWhatNoEquationFollowsFrom) {
  EXPECT_NE(refusalAfter([](RobotModel& m) { m.joints[0].link.inertia_origin_kg_m2(0, 1) += 0.1; }).find("symmetric"),
            std::string::npos);
  EXPECT_NE(refusalAfter([](RobotModel& m) { m.joints[0].link.mass_kg = 0.0; }).find("no mass"), std::string::npos);
}

TEST(CheckModel, RefusesAMassMatrixThatIsNotPositiveDefinite) {
  const auto refuses = [](const std::string& message) {
    return message.find("not positive definite at q = (") != std::string::npos;
  };
  EXPECT_TRUE(refuses(refusalAfter([](RobotModel& m) { m.joints[2].link = LinkInertia{}; })));
  EXPECT_TRUE(refuses(refusalAfter([](RobotModel& m) { m.joints[0].link.inertia_origin_kg_m2(2, 2) = -5.0; })));
}

TEST(CheckModel, RefusesAMassMatrixThatFailsOnlyAwayFromZero) {
  // B11 = Ieq + m3 (r3 + q3)^2 with Ieq = -0.005: positive at q3 = 0, negative around q3 = -r3.
  const std::string message =
      refusalAfter([](RobotModel& m) { m.joints[0].link.inertia_origin_kg_m2(2, 2) -= test::rpp::kIeq + 0.005; });
  EXPECT_NE(message, "");
  EXPECT_EQ(message.find("q = (0.000000, 0.000000, 0.000000)"), std::string::npos) << message;
}

}  // namespace
}  // namespace baton
