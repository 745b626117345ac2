/// Walls that the tip can leave: which of them are looked at together, and that the step which is advised does.
#include <gtest/gtest.h>

#include <vector>

#include "bad_input.hpp"
#include "runtime/monolithic_run.hpp"
#include "runtime/scenario.hpp"

namespace baton {
namespace {

using test::replaced;
using test::rppScenario;

constexpr const char* kInverseDynamics = "law: joint_inverse_dynamics";
constexpr const char* kImpedance = "law: impedance, parameters: {md: 1, kd: 30, kp: 200}";

std::string wall(const std::string& stiffness, const std::string& place = "point_m: [0, 0, 0.45], normal: [0, 0, 1]") {
  return "    - {" + place + ", stiffness_N_per_m: " + stiffness + "}\n";
}

/// The arm runs into them.
std::string impact(const std::string& walls, const std::string& law, const std::string& timing = "step_s: 0.001") {
  return "name: impact\nrobot: rpp.yaml\n" + timing + "\nduration_s: 0.3\nenvironment:\n  walls:\n" + walls +
         "trajectory:\n  waypoints:\n    - {time_s: 0, position: [0, 0, 0]}\n"
         "    - {time_s: 0.2, position: [0.2, 0.1, 0.05]}\ncontrollers: [{name: a, " +
         law + "}]\nactive: a\n";
}

std::string warningOf(const std::string& text) {
  const std::vector<std::string> warnings = rppScenario("impact.yaml", text).warnings;
  return warnings.empty() ? "" : warnings.front();
}

/// Behind these words, up to what follows.
std::string after(const std::string& text, const std::string& words) {
  const std::size_t from = text.find(words);
  if (from == std::string::npos) return "";
  const std::size_t begin = from + words.size();
  return text.substr(begin, text.find(',', begin) - begin);
}

TEST(Impact, TheStepThatIsAdvisedIsShortEnough) {
  std::string many;
  for (int i = 0; i < 16; ++i) many += wall("2e6");
  for (const std::string& walls :
       {wall("3e7"), wall("1e9"), wall("100, damping_N_s_per_m: 1e5"), wall("1.5e7") + wall("1.5e7"), many}) {
    for (const char* law : {kInverseDynamics, kImpedance}) {
      const std::string warning = warningOf(impact(walls, law));
      const std::string step_s = after(warning, "give step_s: ");
      ASSERT_NE(step_s, "") << walls << warning;
      MonolithicRun run(rppScenario("impact.yaml", impact(walls, law, "step_s: " + step_s)));
      EXPECT_TRUE(run.scenario().warnings.empty()) << run.scenario().warnings.front();
      while (run.step()) {
      }
      EXPECT_EQ(run.whatWentWrong(), "") << walls << warning;
    }
  }
}

TEST(Impact, NeedsAShorterStepHoweverManySubstepsThereAre) {
  // The pole of 3e7 N/m is 7728 1/s: RK4 holds it up to 2.828 / 7728 = 366 us.
  EXPECT_EQ(warningOf(impact(wall("3e7"), kInverseDynamics, "step_s: 0.001\nsubsteps: 100")),
            "impact.yaml:3: step_s: wall 1 makes a pole at 7728.08 1/s where the tip touches it, too fast for contact "
            "that begins and ends between steps; give step_s: 0.00025, or a softer wall");
  const std::string held = replaced(wall("3e7"), "}", ", unilateral: false}");
  EXPECT_EQ(warningOf(impact(held, kInverseDynamics, "step_s: 0.001\nsubsteps: 3")), "") << "it cannot be left";
}

TEST(Impact, WallsAreTakenTogetherWhereTheTipCanTouchThemTogether) {
  // Alone each is slow enough, as in the first, two of them are not.
  const auto cause = [](const std::string& walls) { return after(warningOf(impact(walls, kImpedance)), "step_s: "); };
  const std::string one = wall("2.5e6"), deeper = wall("2.5e6", "point_m: [0, 0, 0.5], normal: [0, 0, 1]");
  EXPECT_EQ(cause(one), "");
  EXPECT_EQ(cause(one + deeper), "wall 1 and what is touched with it make a pole at 3154.98 1/s");
  EXPECT_EQ(cause(one + wall("2.5e6", "point_m: [0, 0, 0.4], normal: [0, 0, -2]")), "") << "a gap between them";
  EXPECT_NE(cause(one + wall("2.5e6", "point_m: [0, 0, 0.5], normal: [0, 0, -2]")), "") << "they overlap";
  // One that is to blame alone is named, wherever it stands.
  EXPECT_NE(cause(one + wall("3e7")).find("wall 2 makes a pole"), std::string::npos);
  EXPECT_NE(cause(wall("3e7") + one).find("wall 1 makes a pole"), std::string::npos);
}

}  // namespace
}  // namespace baton
