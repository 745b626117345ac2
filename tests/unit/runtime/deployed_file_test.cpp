/// The files under deploy/ are what people try first and copy: all of them load, and say what is so.
#include <gtest/gtest.h>

#include <filesystem>

#include "bad_input.hpp"
#include "control/law.hpp"
#include "runtime/scenario.hpp"

namespace baton {
namespace {

using test::deployPath;

TEST(DeployedScenarios, AllLoadAndAreNamedAfterTheirFiles) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(deployPath("scenarios"))) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path());
    Scenario s;
    ASSERT_NO_THROW(s = loadScenario(entry.path().string()));
    EXPECT_EQ(s.name, entry.path().stem().string());
    EXPECT_FALSE(s.description.empty());
    ++count;
  }
  EXPECT_GE(count, 4u);
}

TEST(DeployedRobots, AllLoadAndAreNamedAfterTheirFiles) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(deployPath("robots"))) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path());
    EXPECT_EQ(loadRobot(entry.path().string()).name, entry.path().stem().string());
  }
}

TEST(DeployedDemo, TellsTheStoryItsCommentsTell) {
  const Scenario s = loadScenario(deployPath("scenarios/demo.yaml"));
  const Trajectory trajectory(s.robot, s.trajectory);
  const double wall = s.walls.at(0).point_m.z();
  const auto height = [&](std::uint64_t step) {
    Reference reference;
    trajectory.evaluate(static_cast<double>(step) * s.stepSeconds(), reference);
    return reference.X_WE.p.z();
  };
  ASSERT_EQ(s.swaps.size(), 2u);
  EXPECT_EQ(s.active, "tracking");
  // The first handover in free motion, the second with the path inside the wall.
  EXPECT_EQ(s.swaps[0].to, "impedance");
  EXPECT_NEAR(height(s.swaps[0].at_step), 0.555, 0.5e-3);
  EXPECT_LT(height(s.swaps[0].at_step), wall);
  EXPECT_EQ(s.swaps[1].to, "force");
  EXPECT_NEAR(height(s.swaps[1].at_step), wall + 0.025, 1e-12);
  EXPECT_TRUE(findLaw(s.controller("force").law).requires_contact);
  // The path meets the wall at 1.56 s.
  EXPECT_LT(height(3120), wall);
  EXPECT_GT(height(3140), wall);
  // Two springs in balance: Kp (z_d - z) = Ke (z - z_r) leaves 12.5 mm and 2.5 N.
  const double kp = numbers(s.controller("impedance").parameters, "kp")[2], ke = s.walls[0].stiffness_N_per_m;
  const double z = (kp * height(s.end_step) + ke * wall) / (kp + ke);
  EXPECT_NEAR(height(s.end_step) - z, 0.0125, 1e-12);
  EXPECT_NEAR(ke * (z - wall), 2.5, 1e-9);
  EXPECT_EQ(s.trajectory.h_d.z(), 3.0);
}

}  // namespace
}  // namespace baton
