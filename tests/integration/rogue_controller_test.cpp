// A controller that talks nonsense: the test plays it, on real DDS, against a real plant.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "runtime/service.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

constexpr std::uint64_t kBadStep = 50;
constexpr std::uint64_t kLastStep = 100;

class RogueController : public ::testing::TestWithParam<double> {};

TEST_P(RogueController, LosesTheBatonAndNeverReachesTheIntegrator) {
  Bench bench;
  const std::string file =
      bench.write("rogue.yaml", "name: rogue\nrobot: " + (deployFolder() / "robots/rpp.yaml").string() +
                                    "\nstep_s: 0.0005\nduration_s: 0.05\n"
                                    "trajectory: {waypoints: [{time_s: 0, position: [0.1, 0.1, 0.1]}]}\n"
                                    "controllers:\n  - {name: rogue, law: joint_pd}\n"
                                    "  - {name: pd, law: joint_inverse_dynamics}\n"
                                    "active: rogue\nbaton: {fallback: [pd]}\n");
  const std::vector<std::string> common{
      "--scenario", file, "--run", "rogue-run", "--no-recording", "--domain", std::to_string(bench.domain())};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), common.begin(), common.end());
    return more;
  };
  Scenario scenario = loadScenario(file);
  scenario.recording.enabled = false;
  ServiceOptions options;
  options.role = "controller";
  options.name = "rogue";
  options.run = "rogue-run";
  options.domain = bench.domain();
  options.recording = false;
  Service service(options, scenario);
  auto& command = service.output(dds::topics::kJointCommand, {"plant"});
  service.output(dds::topics::kSwapAck, {"plant"});
  std::vector<std::string> holders;
  bool all_finite = true;
  service.input(dds::topics::kPlantState, {"plant"}, [&](const msg::PlantState& state, const dds::RawSample&) {
    holders.emplace_back(state.holder().c_str());
    for (std::size_t i = 0; i < 3; ++i) {
      all_finite = all_finite && std::isfinite(state.position().at(i)) && std::isfinite(state.velocity().at(i)) &&
                   std::isfinite(state.applied_effort().at(i));
    }
    if (holders.back() == "rogue") {
      msg::JointCommand message;
      message.step(state.step());
      message.time_ns(state.time_ns());
      message.controller("rogue");
      message.effort({0.5, 0.25, 0.125});
      if (state.step() == kBadStep) message.effort().at(1) = GetParam();
      command.write(message);
    }
    service.stepDone(state.step());
  });
  service.input(dds::topics::kReference, {"trajectory"}, [](const msg::Reference&, const dds::RawSample&) {});
  service.input(dds::topics::kSwapPlan, {"plant"}, [](const msg::SwapPlan&, const dds::RawSample&) {});
  service.onEnd([&] { service.stop(); });

  std::ignore = bench.start("baton-plant", common, "plant.log");
  std::ignore = bench.start("baton-trajectory", common, "trajectory.log");
  std::ignore = bench.start("baton-controller", with({"--name", "pd"}), "pd.log");
  // A run that hangs fails the test by CTest's limit for it.
  EXPECT_EQ(service.run(), ExitCode::kOk);

  ASSERT_EQ(holders.size(), kLastStep + 1);
  EXPECT_TRUE(all_finite);
  for (std::uint64_t step = 0; step <= kLastStep; ++step) {
    EXPECT_EQ(holders[step], step <= kBadStep ? "rogue" : "pd") << step;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, RogueController,
                         ::testing::Values(std::numeric_limits<double>::quiet_NaN(),
                                           std::numeric_limits<double>::infinity()));

}  // namespace
}  // namespace baton::test
