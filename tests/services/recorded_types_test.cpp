/// The types of a recording's messages, as its schemas declare them.
#include "runtime/recorded_types.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace baton {
namespace {

mcap::Channel channelOf(int id, const std::string& topic) {
  return {.id = mcap::ChannelId{static_cast<std::uint16_t>(id)}, .topic = topic, .message_encoding = "cdr"};
}

mcap::Schema schemaOf(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {.id = mcap::SchemaId{1}, .name = "S", .encoding = "omgidl", .data = {bytes.begin(), bytes.end()}};
}

class RecordedTypesTest : public testing::Test {
 protected:
  std::vector<std::string> complaints;
  RecordedTypes types{[this](const std::string& complaint) { complaints.push_back(complaint); }};
};

TEST_F(RecordedTypesTest, ChannelsOfASchemaShareItsType) {
  const mcap::Schema schema = schemaOf("struct S { long a; };");
  const schema::Type* type = types.typeOf(channelOf(1, "a"), &schema);
  ASSERT_NE(type, nullptr);
  EXPECT_EQ(types.typeOf(channelOf(2, "b"), &schema), type);
  EXPECT_TRUE(complaints.empty());
}

TEST_F(RecordedTypesTest, ASchemaThatCannotBeReadIsReadOnceAndToldOfByTopic) {
  const mcap::Schema bad = schemaOf("struct S { long a }"), good = schemaOf("struct S { long a; };");
  EXPECT_EQ(types.typeOf(channelOf(1, "a"), &bad), nullptr);
  EXPECT_EQ(types.typeOf(channelOf(2, "b"), &good), nullptr) << "the text under this number has been read";
  EXPECT_EQ(types.typeOf(channelOf(1, "a"), &bad), nullptr);
  ASSERT_EQ(complaints.size(), 2U);
  EXPECT_EQ(complaints[0].substr(0, 40), "topic a stays bytes: the text of schema ");
  EXPECT_EQ(complaints[1], "topic b" + complaints[0].substr(7));
}

TEST_F(RecordedTypesTest, ASchemaThatIsDeclaredNowhereIsToldOfAndNoneIsNot) {
  mcap::Channel channel = channelOf(1, "a");
  EXPECT_EQ(types.typeOf(channel, nullptr), nullptr);
  EXPECT_TRUE(complaints.empty());
  channel = channelOf(2, "b");
  channel.schema_id = mcap::SchemaId{7};
  EXPECT_EQ(types.typeOf(channel, nullptr), nullptr);
  ASSERT_EQ(complaints.size(), 1U);
  EXPECT_EQ(complaints[0], "topic b stays bytes: its schema is declared nowhere in the recording");
}

TEST_F(RecordedTypesTest, WhatCannotBeUsedIsNamedWhereItIsUsed) {
  mcap::Schema schema = schemaOf("bitset B { bitfield<3> x; };\nstruct S { long a; };\nstruct T { B b; };");
  EXPECT_NE(types.typeOf(channelOf(1, "a"), &schema), nullptr) << complaints.front();
  schema.name = "T";
  EXPECT_EQ(types.typeOf(channelOf(2, "b"), &schema), nullptr);
  ASSERT_EQ(complaints.size(), 1U);
  EXPECT_EQ(complaints[0],
            "topic b stays bytes: the text of schema T, definition of B, line 1: expected module, struct, union, enum, "
            "bitmask, typedef or const, found 'bitset'");
  schema.name = "Nowhere";
  EXPECT_EQ(types.typeOf(channelOf(3, "c"), &schema), nullptr);
  EXPECT_NE(complaints.back().find("found it nowhere; what cannot be read there: line 1"), std::string::npos)
      << complaints.back();
}

TEST_F(RecordedTypesTest, WithoutASchemaInIdlMessagesStayBytes) {
  mcap::Schema schema = schemaOf("{}");
  schema.encoding = "jsonschema";
  EXPECT_EQ(types.typeOf(channelOf(1, "a"), &schema), nullptr);
  EXPECT_EQ(complaints.size(), 1U);
  EXPECT_EQ(types.typeOf(channelOf(2, "b"), nullptr), nullptr);
  EXPECT_EQ(complaints.size(), 1U) << "of what has no schema nothing is expected";
}

}  // namespace
}  // namespace baton
