// A recording may come from elsewhere: what is missing in it must not change what is there, and its step numbers must
// not be believed.
#include "report/trace.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <type_traits>
#include <vector>

#include "base/error.hpp"
#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/writer.hpp"
#include "report/metrics.hpp"
#include "simulated_run.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

class TraceOfAFile : public testing::Test {
 public:
  TraceOfAFile(const TraceOfAFile&) = delete;
  TraceOfAFile& operator=(const TraceOfAFile&) = delete;

 protected:
  TraceOfAFile() { fs::remove(file_); }
  ~TraceOfAFile() override { fs::remove(file_); }

  /// Writes the states of these steps, q1 = step / 1000 rad, and references for the first of them only. Reads it back.
  Trace recorded(const std::vector<std::uint64_t>& steps) const {
    const Scenario scenario = reportScenario("fig03_joint_pd");
    mcap::WriterOptions options;
    options.sync_on_close = false;
    options.if_exists = mcap::OutputFile::IfExists::kReplace;
    mcap::Writer writer(file_, options);
    const auto attach = [&](const char* name, const std::string& text) {
      writer.addAttachment(name, "application/yaml", 0, 0, mcap::asBytes(text));
    };
    attach("scenario.yaml", scenario.text);
    attach("robot.yaml", scenario.robot_text);
    const auto channelOf = [&](const std::string& topic) { return writer.addChannel(topic, "cdr", mcap::kNoSchema); };
    const mcap::ChannelId states = channelOf(dds::topics::kPlantState.name),
                          references = channelOf(dds::topics::kReference.name);
    const auto write = [&](mcap::ChannelId channel, const auto& message) {
      std::vector<std::byte> buffer(dds::maxPayload<std::remove_cvref_t<decltype(message)>>());
      writer.write(channel, 0, 0, 0, dds::encode(message, buffer));
    };
    const JointVector zero = JointVector::Zero(3);
    msg::PlantState state_message;
    for (const std::uint64_t step : steps) {
      RobotState state{Vector3(1e-3 * static_cast<double>(step), 0.0, 0.0), zero, {}, Vector6::Zero(), zero};
      toMessage({step, 0}, state, "pd", 0, state_message);
      write(states, state_message);
    }
    Reference reference;
    reference.q = reference.qd = reference.qdd = zero;
    msg::Reference reference_message;
    toMessage({steps.front(), 0}, reference, reference_message);
    write(references, reference_message);
    writer.close();
    return readTrace(file_);
  }

  const fs::path file_ = fs::temp_directory_path() / ("baton-trace-" + std::to_string(getpid()) + ".mcap");
};

TEST_F(TraceOfAFile, KeepsItsEndWhereAStateIsMissingBefore) {
  const Trace trace = recorded({10, 11, 13, 14});
  EXPECT_EQ(trace.first_step, 10U);
  ASSERT_EQ(trace.steps(), 5);
  EXPECT_TRUE(std::isnan(trace.q(0, 2)));
  EXPECT_DOUBLE_EQ(trace.q(0, 4), 0.014) << "the last state is there";
  EXPECT_TRUE(trace.h_e.array().isNaN().all()) << "no contact was recorded";
  const Metrics metrics = metricsOf(trace);
  EXPECT_EQ(metrics.unrecorded_steps, 4U) << "all but the first are without state or reference";
  ASSERT_EQ(metrics.joints.size(), 3U);
  EXPECT_TRUE(std::isnan(metrics.joints[0].rms));
  EXPECT_NE(toText(metrics).find("4 steps were not recorded"), std::string::npos);
}

TEST_F(TraceOfAFile, IsRefusedWhereTheStepsCannotBeThoseOfARun) {
  constexpr std::uint64_t kFar = std::uint64_t{1} << 62U;
  EXPECT_THROW((void)recorded({0, 1, 1000}), UsageError) << "two orders more than there is";
  EXPECT_THROW((void)recorded({0, kFar}), UsageError) << "no memory for so many";
  EXPECT_THROW((void)recorded({kFar, kFar + 1}), UsageError) << "no time in ns";
}

}  // namespace
}  // namespace baton::test
