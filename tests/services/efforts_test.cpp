// What a recording says of its controllers: who held the baton, what each commanded or would have, what is missing.
#include "report/efforts.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <type_traits>
#include <vector>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/writer.hpp"
#include "report/shadow.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

// Of demo.yaml.
constexpr std::size_t kTracking = 0, kImpedance = 1, kForce = 2;

/// A recording that a test writes message by message.
class Written {
 public:
  Written() {
    attach("scenario.yaml", scenario_.text);
    attach("robot.yaml", scenario_.robot_text);
  }
  ~Written() { fs::remove(file_); }
  Written(const Written&) = delete;
  Written& operator=(const Written&) = delete;

  /// Everybody's effort and the one felt over the step before, the same in all joints.
  void state(std::uint64_t step, const std::string& holder, double felt) {
    const JointVector zero = JointVector::Zero(3);
    msg::PlantState message;
    toMessage({step, 0}, RobotState{zero, zero, {}, Vector6::Zero(), JointVector::Constant(3, felt)}, holder, 0,
              message);
    write(states_, message);
  }
  void command(std::uint64_t step, const std::string& controller, double effort, bool in_shadow = false) {
    msg::JointCommand message;
    message.step(step);
    message.controller(controller);
    message.effort(std::vector<double>(3, effort));
    write(in_shadow ? shadows_ : commands_, message);
  }
  RecordedEfforts read() {
    writer_.close();
    return readEfforts(file_);
  }

 private:
  static mcap::WriterOptions options() {
    mcap::WriterOptions options;
    options.sync_on_close = false;
    options.if_exists = mcap::OutputFile::IfExists::kReplace;
    return options;
  }
  void attach(const char* name, const std::string& text) {
    writer_.addAttachment(name, "application/yaml", 0, 0, mcap::asBytes(text));
  }
  template <class T>
  void write(mcap::ChannelId channel, const T& message) {
    std::vector<std::byte> buffer(dds::maxPayload<T>());
    writer_.write(channel, 0, 0, 0, dds::encode(message, buffer));
  }

  const Scenario scenario_ = loadScenario((deployFolder() / "scenarios/demo.yaml").string());
  const fs::path file_ = fs::temp_directory_path() / ("baton-efforts-" + std::to_string(getpid()) + ".mcap");
  mcap::Writer writer_{file_, options()};
  const mcap::ChannelId states_ = writer_.addChannel(dds::topics::kPlantState.name, "cdr", mcap::kNoSchema),
                        commands_ = writer_.addChannel(dds::topics::kJointCommand.name, "cdr", mcap::kNoSchema),
                        shadows_ = writer_.addChannel(dds::topics::kShadowCommand.name, "cdr", mcap::kNoSchema);
};

/// Tracking hands over to impedance at step 2; impedance is at odds by 3, then by 4 and last by 1.
void writeHandover(Written& file) {
  const char* const holders[] = {"tracking", "tracking", "impedance", "impedance"};
  const double felt[] = {0.0, 10.0, 11.0, 12.0};
  for (std::uint64_t k = 0; k < 4; ++k) file.state(k, holders[k], felt[k]);
  file.command(0, "tracking", 10.0);
  file.command(0, "impedance", 13.0, true);
  file.command(1, "tracking", 11.0);
  file.command(1, "impedance", 7.0, true);
  file.command(2, "tracking", 12.0);  // the outgoing law's last
  file.command(2, "impedance", 12.5);
}

TEST(RecordedEfforts, AreOfWhoeverCommandedOrStoodBy) {
  Written file;
  writeHandover(file);
  const RecordedEfforts run = file.read();
  EXPECT_EQ(run.holder, (std::vector<int>{kTracking, kTracking, kImpedance, kImpedance}));
  EXPECT_EQ(run.effort[kTracking].row(0).head(3), Eigen::RowVector3d(10.0, 11.0, 12.0));
  EXPECT_EQ(run.effort[kImpedance].row(2).head(3), Eigen::RowVector3d(13.0, 7.0, 12.5));
  EXPECT_TRUE(run.effort[kForce].array().isNaN().all());
  EXPECT_EQ(run.applied(1), Eigen::Vector3d::Constant(11.0));
  EXPECT_TRUE(run.applied(3).hasNaN()) << "the last step is open";
  EXPECT_EQ(run.lost_steps, 0U);
  EXPECT_EQ(run.doubled_steps, 0U);
  EXPECT_TRUE(run.cut.empty());
}

TEST(RecordedEfforts, CountStepsThatAreMissingOrContradictThemselves) {
  Written file;
  file.state(0, "tracking", 0.0);
  file.state(1, "tracking", 0.0);
  file.state(1, "tracking", 0.0);  // twice
  file.state(3, "tracking", 0.0);  // without step 2
  file.state(4, "tracking", 0.0);
  file.state(5, "tracking", 0.0);
  file.command(0, "tracking", 1.0);
  file.command(0, "tracking", 1.0);  // asked for again: the same is no contradiction
  file.command(1, "tracking", 1.0);
  file.command(3, "tracking", 1.0);
  file.command(3, "tracking", 2.0);
  const RecordedEfforts run = file.read();
  EXPECT_EQ(run.lost_steps, 2U) << "the state of step 2, the command of step 4";
  EXPECT_EQ(run.doubled_steps, 2U) << "steps 1 and 3";
}

TEST(Shadow, TellsWhatAControllerThatStoodByWouldHaveChanged) {
  Written file;
  writeHandover(file);
  const RecordedEfforts run = file.read();
  const Shadow shadow = shadowOf(run);
  ASSERT_EQ(shadow.controllers.size(), 3U);
  EXPECT_EQ(shadow.steps, 3U);
  const ShadowController& impedance = shadow.controllers[kImpedance];
  EXPECT_DOUBLE_EQ(impedance.held, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(impedance.silent, 0.0);
  ASSERT_EQ(impedance.joints.size(), 3U);
  const ShadowJoint& joint = impedance.joints[0];
  EXPECT_DOUBLE_EQ(joint.rms, std::sqrt((3.0 * 3.0 + 4.0 * 4.0) / 2.0)) << "13 - 10 and 7 - 11";
  EXPECT_DOUBLE_EQ(joint.largest, 4.0);
  EXPECT_EQ(joint.largest_at_step, 1U);
  EXPECT_DOUBLE_EQ(joint.jump, 3.0) << "7 at step 1, after 10";
  EXPECT_EQ(joint.jump_at_step, 1U);
  EXPECT_DOUBLE_EQ(joint.last_jump, -3.0);
  const ShadowController& force = shadow.controllers[kForce];
  EXPECT_DOUBLE_EQ(force.silent, 1.0);
  EXPECT_TRUE(std::isnan(force.joints[0].rms));
  EXPECT_TRUE(toJson(shadow).at("controllers").at(kForce).at("joints").at(0).at("rms").is_null());
  EXPECT_NE(toText(shadow).find("force (force_pi): held 0.0 %, without effort 100.0 %"), std::string::npos);

  const std::vector<Panel> panels = shadowPanels(run);
  ASSERT_EQ(panels.size(), 3U);
  ASSERT_EQ(panels[0].curves.size(), 3U) << "tracking, impedance and what was applied; force has none";
  EXPECT_EQ(panels[0].curves[2].y.head(3), Eigen::RowVector3d(10.0, 11.0, 12.0));
}

}  // namespace
}  // namespace baton::test
