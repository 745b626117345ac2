#include "runtime/admission.hpp"

#include <gtest/gtest.h>

#include "runtime/service_options.hpp"

namespace baton {
namespace {

using enum dds::WrittenBy;

TEST(Admission, LetsAServiceSpeakOnItsOwnTopics) {
  EXPECT_TRUE(mayWrite(kPlant, kPlantName));
  EXPECT_TRUE(mayWrite(kEnvironment, kEnvironmentName));
  EXPECT_TRUE(mayWrite(kTrajectory, kTrajectoryName));
  EXPECT_TRUE(mayWrite(kControllers, "impedance"));
  for (const char* service : {kPlantName, kEnvironmentName, kTrajectoryName, kRecorderName, "impedance"}) {
    EXPECT_TRUE(mayWrite(kServices, service));
    EXPECT_TRUE(mayWrite(kOperators, service));
  }
  EXPECT_TRUE(mayWrite(kOperators, std::string(kOperatorPrefix) + "123"));
}

TEST(Admission, AndOnNoOther) {
  EXPECT_FALSE(mayWrite(kPlant, "impedance"));
  EXPECT_FALSE(mayWrite(kPlant, ""));
  EXPECT_FALSE(mayWrite(kEnvironment, kPlantName));
  EXPECT_FALSE(mayWrite(kTrajectory, kEnvironmentName));
  for (const char* service : {kPlantName, kEnvironmentName, kTrajectoryName, kRecorderName}) {
    EXPECT_FALSE(mayWrite(kControllers, service)) << service;
  }
  const std::string an_operator = std::string(kOperatorPrefix) + "123";
  for (const dds::WrittenBy topic : {kPlant, kEnvironment, kTrajectory, kControllers, kServices}) {
    EXPECT_FALSE(mayWrite(topic, an_operator));
  }
}

TEST(Admission, TheSupervisorSpeaksForWhoHasDied) {
  for (const dds::WrittenBy topic : {kPlant, kEnvironment, kTrajectory, kControllers, kServices, kOperators}) {
    EXPECT_TRUE(mayWrite(topic, kSupervisorName));
  }
}

/// Nothing of the loop, and nothing that decides about it, may come from an operator.
TEST(Admission, EveryTopicThatIsNoRequestBelongsToServices) {
  for (const dds::TopicFacts& topic : dds::topics::kAll) {
    const bool is_request = std::string_view(topic.name).ends_with("_request");
    EXPECT_EQ(topic.written_by == kOperators, is_request) << topic.name;
  }
}

TEST(Admission, TheYoungerYieldsAndOnlyToWhoHasTheKey) {
  const auto peer = [](const std::string& run, const std::string& service, std::int64_t started_ns) {
    dds::Peer result;
    result.cell = "lab";
    result.run = run;
    result.service = service;
    result.started_ns = started_ns;
    return result;
  };
  const dds::Peer plant = peer("ours", kPlantName, 100);
  for (const bool has_begun : {false, true}) {
    EXPECT_TRUE(yieldsTo(plant, peer("ours", kPlantName, 99), true, has_begun));
    EXPECT_FALSE(yieldsTo(plant, peer("ours", kPlantName, 99), false, has_begun)) << "a stranger says so";
    EXPECT_FALSE(yieldsTo(plant, peer("ours", kPlantName, 101), true, has_begun)) << "the younger does";
    EXPECT_FALSE(yieldsTo(plant, peer("ours", kRecorderName, 99), true, has_begun));
    EXPECT_EQ(yieldsTo(plant, peer("theirs", kPlantName, 99), true, has_begun), !has_begun);
    EXPECT_FALSE(yieldsTo(plant, peer("theirs", kPlantName, 99), false, has_begun)) << "a stranger says so";
    const dds::Peer pd = peer("ours", "pd", 100);
    EXPECT_FALSE(yieldsTo(pd, peer("theirs", "pd", 99), true, has_begun)) << "each run has its own";
    dds::Peer elsewhere = peer("theirs", kPlantName, 99);
    elsewhere.cell = "other";
    EXPECT_FALSE(yieldsTo(plant, elsewhere, true, has_begun));
  }
}

}  // namespace
}  // namespace baton
