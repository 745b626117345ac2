/// The writer that stands in for a recorded one: its names and QoS.
#include "endpoints.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace baton {
namespace {

mcap::Channel recordedChannel(const std::string& durability) {
  return {.id = mcap::ChannelId{3},
          .schema_id = mcap::SchemaId{1},
          .topic = "plant_state",
          .message_encoding = "cdr",
          .metadata = {
              {"type", "baton::msg::PlantState"},
              {"qos", "reliability: reliable\ndurability: " + durability + "\nownership: shared\nkeyed: false\n"}}};
}

TEST(ReplayEndpoint, TakesTopicTypeAndDurabilityFromTheRecording) {
  const dds::EndpointOptions loop = replayEndpoint(recordedChannel("volatile"), nullptr, {});
  EXPECT_EQ(loop.topic, "plant_state");
  EXPECT_EQ(loop.type, "baton::msg::PlantState");
  EXPECT_EQ(loop.profile, dds::Profile::kLoop);
  EXPECT_FALSE(loop.keyed);
  EXPECT_FALSE(loop.exclusive_ownership);
  EXPECT_EQ(replayEndpoint(recordedChannel("transient_local"), nullptr, {}).profile, dds::Profile::kEvent);
}

TEST(ReplayEndpoint, TakesKeysAndOwnershipFromTheRecording) {
  mcap::Channel channel = recordedChannel("volatile");
  channel.metadata["qos"] = "durability: volatile\nownership: exclusive\nkeyed: true\n";
  const dds::EndpointOptions endpoint = replayEndpoint(channel, nullptr, {});
  EXPECT_TRUE(endpoint.keyed);
  EXPECT_TRUE(endpoint.exclusive_ownership);
}

TEST(ReplayEndpoint, OffersLateJoinersEverythingWhenTheQosIsNotRecorded) {
  mcap::Channel channel = recordedChannel("volatile");
  channel.metadata.erase("qos");
  EXPECT_EQ(replayEndpoint(channel, nullptr, {}).profile, dds::Profile::kEvent);
}

TEST(ReplayEndpoint, FallsBackToTheNameOfTheSchema) {
  mcap::Channel channel = recordedChannel("volatile");
  channel.metadata.erase("type");
  const mcap::Schema schema{.id = mcap::SchemaId{1}, .name = "other::Type", .encoding = "omgidl"};
  EXPECT_EQ(replayEndpoint(channel, &schema, {}).type, "other::Type");
  EXPECT_THROW((void)replayEndpoint(channel, nullptr, {}), UsageError);
}

TEST(ReplayEndpoint, RefusesWhatIsNotCdr) {
  mcap::Channel channel = recordedChannel("volatile");
  channel.message_encoding = "json";
  EXPECT_THROW((void)replayEndpoint(channel, nullptr, {}), UsageError);
}

TEST(ReplayEndpoint, RenamesTheTopicAlone) {
  const dds::EndpointOptions endpoint =
      replayEndpoint(recordedChannel("volatile"), nullptr, {{"plant_state", "seen"}, {"contact", "felt"}});
  EXPECT_EQ(endpoint.topic, "seen");
  EXPECT_EQ(endpoint.type, "baton::msg::PlantState");
}

}  // namespace
}  // namespace baton
