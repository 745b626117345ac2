#include "control/anti_windup.hpp"

#include <gtest/gtest.h>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

RobotModel limitedRobot() {
  RobotModel robot = rppRobot();
  robot.joints[0].effort_limit = 10.0;
  robot.joints[1].effort_limit = 5.0;
  return robot;
}

TEST(AntiWindup, SeesWhatTheLimitCutAndWhichWay) {
  const RobotModel robot = limitedRobot();
  const JointVector commanded = Vector3(12.0, -7.0, 300.0);
  JointVector applied = commanded;
  ASSERT_EQ(saturateEffort(robot, applied), 2);
  EXPECT_EQ(cutDirections(robot, commanded, applied), JointVector(Vector3(1.0, -1.0, 0.0)));
}

TEST(AntiWindup, AFadingRemainderIsNotACut) {
  const RobotModel robot = limitedRobot();
  const JointVector nothing = JointVector::Zero(3);
  // Below the limit the applied effort may be anything; at the limit it may have been put there by the remainder.
  EXPECT_EQ(cutDirections(robot, Vector3(4.0, -2.0, 1.0), Vector3(3.0, -1.0, 7.0)), nothing);
  EXPECT_EQ(cutDirections(robot, Vector3(4.0, -2.0, 1.0), Vector3(10.0, -5.0, 1.0)), nothing);
  EXPECT_EQ(cutDirections(robot, Vector3(-12.0, 2.0, 1.0), Vector3(10.0, -5.0, 1.0)), nothing);
}

TEST(AntiWindup, NothingIsCutBeforeTheFirstCommand) {
  EXPECT_EQ(cutDirections(limitedRobot(), JointVector(), Vector3(10.0, 5.0, 0.0)), JointVector(JointVector::Zero(3)));
}

TEST(AntiWindup, OnlyMoreOfTheSamePushesFurther) {
  const JointVector cut = Vector3(1.0, -1.0, 0.0);
  EXPECT_TRUE(pushesFurther(cut, Vector3(0.1, 0.0, 0.0)));
  EXPECT_TRUE(pushesFurther(cut, Vector3(-0.1, -0.1, 0.0)));
  EXPECT_FALSE(pushesFurther(cut, Vector3(-0.1, 0.1, 0.0)));
  EXPECT_FALSE(pushesFurther(cut, Vector3(0.0, 0.0, 9.0)));
}

}  // namespace
}  // namespace baton
