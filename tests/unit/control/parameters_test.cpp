#include "control/parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "control/law.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

std::vector<ParameterSpec> specs() {
  return {{.name = "kp",
           .unit = "N/m",
           .doc = "stiffness",
           .size = ParameterSize::kPerJoint,
           .default_numbers = {90.0},
           .minimum = 0.0,
           .choices = {}},
          {.name = "alpha",
           .unit = "",
           .doc = "a share",
           .size = ParameterSize::kScalar,
           .default_numbers = {0.5},
           .minimum = 0.0,
           .maximum = 1.0,
           .choices = {}},
          {.name = "kd",
           .unit = "",
           .doc = "six",
           .size = ParameterSize::kSix,
           .default_numbers = {1, 2, 3, 4, 5, 6},
           .choices = {}},
          {.name = "gravity",
           .unit = "",
           .doc = "a word",
           .size = ParameterSize::kChoice,
           .default_numbers = {},
           .choices = {"full", "none", "fixed"}}};
}

std::string messageOf(const ParameterValues& given) {
  try {
    (void)completeParameters(specs(), given, 3);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<double> list(std::initializer_list<double> values) { return values; }

TEST(Parameters, DefaultsFillWhatIsNotGiven) {
  const ParameterValues values = completeParameters(specs(), {}, 3);
  EXPECT_EQ(values.size(), 4u);
  EXPECT_EQ(numbers(values, "kp"), list({90.0, 90.0, 90.0}));
  EXPECT_EQ(number(values, "alpha"), 0.5);
  EXPECT_EQ(numbers(values, "kd"), list({1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(choice(values, "gravity"), "full");
}

TEST(Parameters, OneNumberStandsForAll) {
  const ParameterValues values =
      completeParameters(specs(), {{"kp", list({7.0})}, {"kd", list({2.0})}, {"gravity", "none"}}, 2);
  EXPECT_EQ(numbers(values, "kp"), list({7.0, 7.0}));
  EXPECT_EQ(numbers(values, "kd"), list({2.0, 2.0, 2.0, 2.0, 2.0, 2.0}));
  EXPECT_EQ(choice(values, "gravity"), "none");
}

TEST(Parameters, CompletingTwiceChangesNothing) {
  const ParameterValues once = completeParameters(specs(), {{"kp", list({1.0, 2.0, 3.0})}}, 3);
  EXPECT_EQ(completeParameters(specs(), once, 3), once);
}

TEST(Parameters, ComeOutAsVectors) {
  const ParameterValues values = completeParameters(specs(), {{"kp", list({1.0, 2.0})}}, 2);
  EXPECT_EQ(vector<JointVector>(values, "kp"), Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(vector<Vector6>(values, "kd")(5), 6.0);
}

TEST(Parameters, MessagesSayWhatWasExpectedAndFound) {
  EXPECT_EQ(messageOf({{"kp", list({1.0, 2.0})}}),
            "parameter 'kp' [N/m]: expected 1 or 3 numbers, found 2 numbers: 1, 2");
  EXPECT_EQ(messageOf({{"kp", std::vector<double>{}}}),
            "parameter 'kp' [N/m]: expected 1 or 3 numbers, found no number");
  EXPECT_EQ(messageOf({{"kp", "stiff"}}), "parameter 'kp' [N/m]: expected 1 or 3 numbers, found 'stiff'");
  EXPECT_EQ(messageOf({{"kp", list({1.0, -2.0, 3.0})}}),
            "parameter 'kp' [N/m]: expected numbers >= 0, found 3 numbers: 1, -2, 3");
  EXPECT_EQ(messageOf({{"kp", list({std::nan("")})}}),
            "parameter 'kp' [N/m]: expected finite numbers, found 1 number: nan");
  EXPECT_EQ(messageOf({{"alpha", list({1.5})}}),
            "parameter 'alpha': expected numbers >= 0 and <= 1, found 1 number: 1.5");
  EXPECT_EQ(messageOf({{"alpha", list({0.1, 0.2})}}),
            "parameter 'alpha': expected 1 number, found 2 numbers: 0.1, 0.2");
  EXPECT_EQ(messageOf({{"gravity", "off"}}), "parameter 'gravity': expected one of full, none, fixed, found 'off'");
  EXPECT_EQ(messageOf({{"gravity", list({1.0})}}),
            "parameter 'gravity': expected one of full, none, fixed, found 1 number: 1");
}

TEST(Parameters, UnknownNamesGetASuggestionWhenOneIsNear) {
  EXPECT_EQ(messageOf({{"gravty", "full"}}),
            "unknown parameter 'gravty'; did you mean 'gravity'? Known: kp, alpha, kd, gravity");
  EXPECT_EQ(messageOf({{"wavelength", list({1.0})}}), "unknown parameter 'wavelength'; known: kp, alpha, kd, gravity");
}

TEST(Laws, MistakesNameTheLaw) {
  const RobotModel robot = test::rppRobot();
  const auto message = [&](const std::string& law, const ParameterValues& given) -> std::string {
    try {
      (void)makeLaw(law, robot, given);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message("joint_pd", {{"kp", list({-1.0})}}),
            "law joint_pd: parameter 'kp' [N m/rad or N/m]: expected numbers >= 0, found 1 number: -1");
  EXPECT_EQ(message("joint_pid", {}).rfind("unknown law 'joint_pid'; did you mean 'joint_pd'? Known: ", 0), 0u);
  EXPECT_EQ(message("impedance", {}), "accepted");
}

}  // namespace
}  // namespace baton
