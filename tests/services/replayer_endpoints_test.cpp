/// The writer that stands in for a recorded one: its names and QoS.
#include "endpoints.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

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

TEST(ReplayEndpoint, TakesWhatReadersMayDemandFromTheRecording) {
  mcap::Channel channel = recordedChannel("volatile");
  EXPECT_FALSE(replayEndpoint(channel, nullptr, {}).best_effort);
  EXPECT_EQ(replayEndpoint(channel, nullptr, {}).deadline_ns, 0);
  channel.metadata["qos"] =
      "reliability: best_effort\ndurability: volatile\nownership: exclusive\nkeyed: true\ndeadline_ns: 20000000\n"
      "liveliness: manual_by_topic\nlease_ns: 3000000000\nownership_strength: 7\n";
  const dds::EndpointOptions endpoint = replayEndpoint(channel, nullptr, {});
  EXPECT_TRUE(endpoint.best_effort);
  EXPECT_EQ(endpoint.deadline_ns, 20'000'000);
  EXPECT_EQ(endpoint.liveliness,
            (dds::Liveliness{.kind = dds::Liveliness::Kind::kManualByTopic, .lease_ns = 3'000'000'000}));
  EXPECT_EQ(endpoint.ownership_strength, 7U);
  channel.metadata["qos"] = "durability: volatile\ndeadline_ns: soon\nlease_ns: -1\n";
  EXPECT_EQ(replayEndpoint(channel, nullptr, {}).deadline_ns, 0) << "what is no number promises nothing";
  EXPECT_EQ(replayEndpoint(channel, nullptr, {}).liveliness, dds::Liveliness{});
}

TEST(ReplayEndpoint, BelievesNoNumberBeyondItsRange) {
  mcap::Channel channel = recordedChannel("volatile");
  const auto withNumber = [&](const std::string& text) {
    channel.metadata["qos"] = "deadline_ns: " + text + "\nlease_ns: " + text + "\nownership_strength: " + text + "\n";
    return replayEndpoint(channel, nullptr, {});
  };
  const dds::EndpointOptions beyond = withNumber("99999999999999999999");
  EXPECT_EQ(beyond.deadline_ns, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(beyond.liveliness.lease_ns, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(beyond.ownership_strength, std::numeric_limits<std::uint32_t>::max());
  for (const char* text : {"", "-1", "-99999999999999999999", "20ms", "0x20", " 20", "1e9"}) {
    const dds::EndpointOptions none = withNumber(text);
    EXPECT_EQ(none.deadline_ns, 0) << text;
    EXPECT_EQ(none.liveliness.lease_ns, 0) << text;
    EXPECT_EQ(none.ownership_strength, 0U) << text;
  }
}

TEST(ReplayEndpoint, PromisesNothingThatNobodyCanKeep) {
  mcap::Channel channel = recordedChannel("volatile");
  for (const char* text : {"1", "2", "99999"}) {
    channel.metadata["qos"] = std::string("deadline_ns: ") + text + "\nlease_ns: " + text + "\n";
    const dds::EndpointOptions endpoint = replayEndpoint(channel, nullptr, {});
    EXPECT_EQ(endpoint.deadline_ns, 100'000) << text;
    EXPECT_EQ(endpoint.liveliness.lease_ns, 100'000) << text;
  }
}

TEST(ReplayEndpoint, ReadsTheTruthValuesThatEprosimasRecorderWrites) {
  mcap::Channel channel = recordedChannel("volatile");
  channel.metadata["qos"] = "reliability: true\ndurability: false\nownership: true\nkeyed: true";
  dds::EndpointOptions endpoint = replayEndpoint(channel, nullptr, {});
  EXPECT_EQ(endpoint.profile, dds::Profile::kLoop);
  EXPECT_TRUE(endpoint.keyed);
  EXPECT_TRUE(endpoint.exclusive_ownership);
  channel.metadata["qos"] = "reliability: true\ndurability: true\nownership: false\nkeyed: false";
  endpoint = replayEndpoint(channel, nullptr, {});
  EXPECT_EQ(endpoint.profile, dds::Profile::kEvent);
  EXPECT_FALSE(endpoint.keyed);
  EXPECT_FALSE(endpoint.exclusive_ownership);
}

TEST(ReplayEndpoint, BelievesTheFullPoliciesWhereThereAreSome) {
  mcap::Channel channel = recordedChannel("volatile");
  channel.metadata["qos"] = "reliability: true\ndurability: true\nownership: false\nkeyed: false\n";
  channel.metadata["qos_policies"] = "reliability: reliable\ndurability: volatile\nownership: exclusive\n";
  const dds::EndpointOptions endpoint = replayEndpoint(channel, nullptr, {});
  EXPECT_EQ(endpoint.profile, dds::Profile::kLoop);
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

TEST(ReplayEndpoint, RefusesNamesThatDdsWouldChange) {
  const auto error = [](const std::string& topic, const std::string& type) {
    mcap::Channel channel = recordedChannel("volatile");
    channel.topic = topic;
    channel.metadata["type"] = type;
    try {
      (void)replayEndpoint(channel, nullptr, {});
      return std::string();
    } catch (const UsageError& refused) {
      return std::string(refused.what());
    }
  };
  EXPECT_EQ(error(std::string(255, 't'), std::string(255, 'T')), "");
  EXPECT_EQ(error("", "T"),
            "topic : expected a name of 1 to 255 bytes in UTF-8 without control characters, found none");
  EXPECT_NE(error("t", std::string(256, 'T')).find("of 256 bytes"), std::string::npos);
  EXPECT_NE(error(std::string(256, 't'), "T"), "");
  EXPECT_NE(error(std::string("t\0u", 3), "T"), "");
  EXPECT_EQ(error("t\033[2J", "T").find('\033'), std::string::npos) << "fit for a terminal";
  EXPECT_EQ(replayEndpoint(recordedChannel("volatile"), nullptr, {{"plant_state", "seen"}}).topic, "seen");
}

TEST(ReplayEndpoint, OneTopicHasOneTypeWithAKeyOrWithout) {
  const auto endpoint = [](const std::string& topic, const std::string& type, bool keyed = false) {
    return dds::EndpointOptions{.topic = topic, .type = type, .keyed = keyed};
  };
  std::map<mcap::ChannelId, dds::EndpointOptions> endpoints{{mcap::ChannelId{1}, endpoint("a", "A")},
                                                            {mcap::ChannelId{2}, endpoint("b", "A")},
                                                            {mcap::ChannelId{3}, endpoint("a", "A")}};
  EXPECT_TRUE(contradictions(endpoints).empty());
  endpoints[mcap::ChannelId{4}] = endpoint("a", "B");
  EXPECT_EQ(contradictions(endpoints),
            (std::map<std::string, std::string>{{"a", "topic a: expected one type, found A and B"}}));
  endpoints[mcap::ChannelId{5}] = endpoint("b", "A", true);
  EXPECT_EQ(contradictions(endpoints).size(), 2U);
  EXPECT_NE(contradictions(endpoints).at("b").find("a key"), std::string::npos);
}

TEST(ReplayEndpoint, RenamesTheTopicAlone) {
  const dds::EndpointOptions endpoint =
      replayEndpoint(recordedChannel("volatile"), nullptr, {{"plant_state", "seen"}, {"contact", "felt"}});
  EXPECT_EQ(endpoint.topic, "seen");
  EXPECT_EQ(endpoint.type, "baton::msg::PlantState");
}

}  // namespace
}  // namespace baton
