// However short a run is, whoever supervises it hears how it went: the test plays the supervisor, on real DDS.
#include <gtest/gtest.h>

#include <signal.h>

#include <atomic>
#include <string>

#include "runtime/service.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

TEST(SupervisedStart, WaitsForTheSupervisorAndAllItsReaders) {
  Bench bench;
  const std::string file =
      bench.write("short.yaml", "name: short\nrobot: " + (deployFolder() / "robots/rpp.yaml").string() +
                                    "\nstep_s: 0.001\nduration_s: 0.005\n"
                                    "trajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}\n"
                                    "controllers: [{name: pd, law: joint_pd}]\nactive: pd\n");
  const std::vector<std::string> common{
      "--scenario", file, "--run", "short-run", "--no-recording", "--domain", std::to_string(bench.domain())};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), common.begin(), common.end());
    return more;
  };
  const int plant = bench.start("baton-plant", with({"--supervised"}), "plant.log");
  std::ignore = bench.start("baton-trajectory", common, "trajectory.log");
  std::ignore = bench.start("baton-controller", with({"--name", "pd"}), "pd.log");
  ServiceOptions options;
  options.role = options.name = kSupervisorName;
  options.run = "short-run";
  options.domain = bench.domain();
  options.recording = false;
  {
    dds::ParticipantOptions onlooker = options.participant();
    onlooker.service = "onlooker";
    dds::Participant participant(onlooker);
    std::atomic<bool> is_waited_for = false;
    const dds::Reader<msg::SimStatus> reader(
        participant, dds::topics::kSimStatus, [&](const msg::SimStatus& status, const dds::RawSample&) {
          is_waited_for = status.state() == msg::SIM_STATE_STARTING && status.waiting_for() == kSupervisorName;
        });
    ASSERT_TRUE(eventually([&] { return is_waited_for.load(); }));
  }
  Scenario scenario = loadScenario(file);
  scenario.recording.enabled = false;
  Service service(options, scenario);
  service.answersNoSteps();
  msg::SimStatus last;
  std::vector<msg::TimingStatus> timing;
  service.onSimStatus([&](const msg::SimStatus& status) { last = status; });
  service.input(dds::topics::kBatonStatus, {kPlantName}, [](const msg::BatonStatus&, const dds::RawSample&) {});
  service.input(dds::topics::kSwapOutcome, {kPlantName}, [](const msg::SwapOutcome&, const dds::RawSample&) {});
  service.input(dds::topics::kSwapReport, {kPlantName}, [](const msg::SwapReport&, const dds::RawSample&) {});
  service.input(dds::topics::kTimingStatus, {kPlantName},
                [&](const msg::TimingStatus& one, const dds::RawSample&) { timing.push_back(one); });
  // Like the supervisor: the plant is told to leave, and what has not been heard by then never will be.
  service.onEnd([&] {
    EXPECT_EQ(kill(plant, SIGTERM), 0);
    EXPECT_EQ(bench.wait(plant), 0);
    service.stop();
  });
  // A run that hangs fails the test by CTest's limit for it.
  EXPECT_EQ(service.run(), ExitCode::kOk);

  EXPECT_EQ(last.state(), msg::SIM_STATE_FINISHED);
  EXPECT_EQ(last.step(), 5U);
  EXPECT_NE(last.chain_hash(), 0U);
  ASSERT_FALSE(timing.empty());
  EXPECT_EQ(timing.back().step(), 5U);
}

}  // namespace
}  // namespace baton::test
