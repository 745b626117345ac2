// A second copy of a service that has sent something before it heard of the first says what it sent: the recording has
// those samples, and would be incomplete. The test plays the service and the plant, on real DDS.
#include <gtest/gtest.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "runtime/service.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

class GiveWay : public ::testing::Test {
 protected:
  GiveWay() {
    const std::string file =
        bench_.write("short.yaml", "name: short\nrobot: " + (deployFolder() / "robots/rpp.yaml").string() +
                                       "\nstep_s: 0.001\nduration_s: 0.005\n"
                                       "trajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}\n"
                                       "controllers: [{name: pd, law: joint_pd}]\nactive: pd\n");
    options_.role = options_.name = kTrajectoryName;
    options_.run = "short-run";
    options_.domain = bench_.domain();
    dds::ParticipantOptions plant = options_.participant();
    plant.service = kPlantName;
    participant_ = std::make_unique<dds::Participant>(plant);
    sim_status_ = std::make_unique<dds::Writer<msg::SimStatus>>(*participant_, dds::topics::kSimStatus);
    manifests_ = std::make_unique<dds::Reader<msg::ServiceManifest>>(
        *participant_, dds::topics::kServiceManifest,
        [this](const msg::ServiceManifest& manifest, const dds::RawSample&) {
          const std::lock_guard lock(mutex_);
          heard_.push_back(manifest);
        });
    scenario_ = loadScenario(file);
  }

  /// A service that gives way as soon as it is ready, having said this much.
  void giveWayAfter(int references) {
    Service service(options_, scenario_);
    dds::Writer<msg::Reference>& out = service.output(dds::topics::kReference, {kPlantName});
    const dds::Reader<msg::Reference> reader(*participant_, dds::topics::kReference,
                                             [](const msg::Reference&, const dds::RawSample&) {});
    // Somebody reads its manifests too by the time that it is ready: they were declared before.
    service.onReady([&] {
      for (int i = 0; i < references; ++i) out.write({});
      service.giveWay("the test wants it");
      service.giveWay("and says so twice");
    });
    EXPECT_EQ(service.run(), ExitCode::kUnavailable);
  }

  std::vector<msg::ServiceManifest> manifests() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  Bench bench_;
  ServiceOptions options_;
  Scenario scenario_;
  std::unique_ptr<dds::Participant> participant_;
  std::mutex mutex_;
  std::vector<msg::ServiceManifest> heard_;
  std::unique_ptr<dds::Writer<msg::SimStatus>> sim_status_;
  std::unique_ptr<dds::Reader<msg::ServiceManifest>> manifests_;
};

TEST_F(GiveWay, TellsWhatWasSentBefore) {
  giveWayAfter(3);
  ASSERT_TRUE(eventually([&] { return !manifests().empty(); }));
  ASSERT_EQ(manifests().size(), 1U);
  const msg::ServiceManifest manifest = manifests()[0];
  EXPECT_STREQ(manifest.name().c_str(), kSecondCopyName) << "the trajectory's own is still to come";
  ASSERT_EQ(manifest.streams().size(), 1U);
  EXPECT_STREQ(manifest.streams()[0].topic().c_str(), dds::topics::kReference.name);
  EXPECT_EQ(manifest.streams()[0].count(), 3U);
}

TEST_F(GiveWay, IsSilentWhenNothingWas) {
  giveWayAfter(0);
  EXPECT_TRUE(manifests().empty());
}

}  // namespace
}  // namespace baton::test
