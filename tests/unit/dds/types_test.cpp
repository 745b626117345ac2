/// The chain of hashes, the text of a GUID, and the topic table against the IDL.
#include "dds/types.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "dds/hash.hpp"
#include "dds/topics.hpp"
#include "msg/idl_text.hpp"

namespace baton::dds {
namespace {

std::span<const std::byte> bytesOf(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }

std::uint64_t chained(const std::vector<std::string>& payloads) {
  std::uint64_t hash = 0;
  for (const std::string& payload : payloads) hash = chainHash(hash, bytesOf(payload));
  return hash;
}

TEST(Guid, ItsTextLeadsBackToIt) {
  std::mt19937 generator(4);
  for (int i = 0; i < 100; ++i) {
    Guid guid;
    for (std::uint8_t& byte : guid.bytes) byte = static_cast<std::uint8_t>(generator());
    EXPECT_EQ(guidCalled(toString(guid)), guid);
  }
  for (const char* text : {"", "0123456789abcdef01234567.0000010", "0123456789abcdef01234567000000103",
                           "0123456789abcdef01234567.0000010g", "0123456789abcdef01234567.000001030"}) {
    EXPECT_FALSE(guidCalled(text)) << text;
  }
}

TEST(ChainHash, IsXxh3SoRecordingsCanBeCheckedByAnybody) {
  // XXH3_64bits of nothing, as published with the algorithm.
  EXPECT_EQ(chainHash(0, {}), 0x2D06'8005'38D3'94C2u);
}

TEST(ChainHash, DependsOnEveryPayloadAndOnTheirOrder) {
  const std::uint64_t reference = chained({"one", "two", "three"});
  EXPECT_EQ(chained({"one", "two", "three"}), reference);
  EXPECT_NE(chained({"two", "one", "three"}), reference);
  EXPECT_NE(chained({"one", "two"}), reference);
  EXPECT_NE(chained({"one", "two", "three", ""}), reference);
  EXPECT_NE(chained({"", "one", "two", "three"}), reference);
}

TEST(ChainHash, DependsOnWhereOnePayloadEndsAndTheNextBegins) {
  EXPECT_NE(chained({"onetwo"}), chained({"one", "two"}));
  EXPECT_NE(chained({"on", "etwo"}), chained({"one", "two"}));
}

TEST(ChainHash, EveryBitCounts) {
  std::mt19937 generator(50);
  for (const std::size_t size :
       {1u, 4u, 16u, 17u, 128u, 129u, 240u, 241u, 1024u, 1025u}) {  // XXH3 changes method at some
    std::vector<std::byte> payload(size);
    for (std::byte& b : payload) b = static_cast<std::byte>(generator());
    std::set<std::uint64_t> hashes{chainHash(1, payload), chainHash(2, payload)};
    for (std::size_t bit = 0; bit < 8 * size; ++bit) {
      payload[bit / 8] ^= std::byte{1} << (bit % 8);
      hashes.insert(chainHash(1, payload));
      payload[bit / 8] ^= std::byte{1} << (bit % 8);
    }
    EXPECT_EQ(hashes.size(), 8 * size + 2) << size;  // a collision among some 10^4 of 2^64 has a chance of 10^-12
  }
}

Guid guidOf(std::uint8_t first) {
  Guid guid;
  for (std::size_t i = 0; i < guid.bytes.size(); ++i) guid.bytes[i] = static_cast<std::uint8_t>(first + 17 * i);
  return guid;
}

TEST(Guids, ReadAsDdsToolsPrintThem) {
  EXPECT_EQ(toString(Guid{}), "000000000000000000000000.00000000");
  EXPECT_EQ(toString(guidOf(0)), "00112233445566778899aabb.ccddeeff");
}

TEST(Guids, ThePrefixIsTheParticipant) {
  const Guid guid = guidOf(1);
  const GuidPrefix prefix = prefixOf(guid);
  EXPECT_TRUE(std::equal(prefix.begin(), prefix.end(), guid.bytes.begin()));
  Guid sibling = guid;
  sibling.bytes[15] ^= 1;
  EXPECT_EQ(prefixOf(sibling), prefix);
  EXPECT_NE(sibling, guid);
  Guid stranger = guid;
  stranger.bytes[11] ^= 1;
  EXPECT_NE(prefixOf(stranger), prefix);
}

TEST(TopicTable, EveryNameIsUsedOnce) {
  std::set<std::string> names;
  for (const TopicFacts& topic : topics::kAll) EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
}

TEST(TopicTable, EveryTypeIsInTheIdl) {
  std::set<std::string, std::less<>> types;
  for (const msg::IdlText& entry : msg::allIdlTexts()) types.insert(std::string(entry.type_name));
  for (const TopicFacts& topic : topics::kAll)
    EXPECT_TRUE(types.contains(topic.type)) << topic.name << ": " << topic.type;
}

/// What a row of the table in idl/README.md says of a topic. Its columns: topic, type, writer, readers, QoS, units.
using DocumentedTopics = std::map<std::string, std::vector<std::string>>;

DocumentedTopics documentedTopics() {
  DocumentedTopics rows;
  std::ifstream readme(BATON_TEST_IDL_README);
  EXPECT_TRUE(readme) << "cannot read " << BATON_TEST_IDL_README;
  for (std::string line; std::getline(readme, line);) {
    const std::regex row(R"(^\| `(\w+)` \| `(\w+)` \| (.*?) \| (.*?) \| (\w+) \|.*$)");
    if (std::smatch cells; std::regex_match(line, cells, row))
      rows[cells[1]] = {cells[2], cells[3], cells[4], cells[5]};
  }
  return rows;
}

TEST(TopicTable, IsTheOneThatTheReadmeShows) {
  const std::map<Profile, std::string> profiles{{Profile::kLoop, "loop"},
                                                {Profile::kEvent, "event"},
                                                {Profile::kStatus, "status"},
                                                {Profile::kRequest, "request"}};
  const std::map<RecordedFrom, std::string> writers{{RecordedFrom::kPlant, "plant"},
                                                    {RecordedFrom::kTrajectory, "trajectory"},
                                                    {RecordedFrom::kEnvironment, "environment"},
                                                    {RecordedFrom::kControllers, "controller"},
                                                    {RecordedFrom::kServices, "every service"}};
  DocumentedTopics rows = documentedTopics();
  for (const TopicFacts& topic : topics::kAll) {
    ASSERT_TRUE(rows.contains(topic.name)) << "idl/README.md has no row for " << topic.name;
    const std::vector<std::string>& row = rows[topic.name];
    EXPECT_EQ("baton::msg::" + row[0], topic.type) << topic.name;
    EXPECT_EQ(row[3], profiles.at(topic.profile)) << topic.name;
    if (topic.recorded_from != RecordedFrom::kNobody) {
      EXPECT_NE(row[1].find(writers.at(topic.recorded_from)), std::string::npos)
          << topic.name << ", writer: " << row[1];
    }
    rows.erase(topic.name);
  }
  for (const auto& [name, row] : rows) ADD_FAILURE() << "idl/README.md has a row for " << name << ", which is no topic";
}

TEST(IdlTexts, EveryTypeIsListedOnceAndDefinedInItsText) {
  std::set<std::string_view> names;
  for (const msg::IdlText& entry : msg::allIdlTexts()) {
    EXPECT_TRUE(names.insert(entry.type_name).second) << entry.type_name;
    const std::string bare(entry.type_name.substr(entry.type_name.rfind(':') + 1));
    EXPECT_TRUE(entry.type_name == "baton::msg::" + bare);
    EXPECT_TRUE(std::regex_search(std::string(entry.text), std::regex("struct +" + bare + " *\\{"))) << bare;
  }
}

/// The bound of every sequence and string of the IDL is a number, which not every tool can do without (idl/README.md).
TEST(IdlTexts, BoundsAreTheConstantsThatTheServicesKnow) {
  const std::map<std::string, std::int64_t, std::less<>> bounds{{"double", msg::MAX_JOINTS},
                                                                {"octet", msg::MAX_CHECKPOINT},
                                                                {"string<32>", msg::MAX_WORDS},
                                                                {"baton::msg::Parameter", msg::MAX_PARAMETERS},
                                                                {"baton::msg::ParameterValue", msg::MAX_PARAMETERS},
                                                                {"baton::msg::BatonMember", msg::MAX_CONTROLLERS},
                                                                {"baton::msg::StreamManifest", msg::MAX_STREAMS},
                                                                {"baton::msg::WriterLoss", msg::MAX_LOSSES}};
  const std::set<std::int64_t> texts{64, 120, 200, 400, 2000, 4096};  // the bounds of strings that are no names
  const std::regex sequence(R"(sequence<(.+?), *(\w+)>)"), string(R"(string<(\w+)>)");
  for (const msg::IdlText& entry : msg::allIdlTexts()) {
    const std::string text(entry.text);
    for (std::sregex_iterator it(text.begin(), text.end(), sequence), end; it != end; ++it) {
      ASSERT_TRUE(bounds.contains((*it)[1].str())) << it->str() << ": teach this test its bound";
      EXPECT_EQ((*it)[2].str(), std::to_string(bounds.at((*it)[1].str()))) << it->str();
    }
    for (std::sregex_iterator it(text.begin(), text.end(), string), end; it != end; ++it) {
      const std::string bound = (*it)[1];
      EXPECT_TRUE(bound == std::to_string(msg::MAX_NAME) || texts.contains(std::atoll(bound.c_str()))) << it->str();
    }
  }
}

TEST(IdlTexts, EveryTextStandsAlone) {
  const std::regex mention("baton::msg::([A-Za-z_0-9]+)");
  for (const msg::IdlText& entry : msg::allIdlTexts()) {
    const std::string text(entry.text);
    EXPECT_EQ(text.find('#'), std::string::npos) << entry.type_name << ": no preprocessor lines";
    EXPECT_EQ(text.find("//"), std::string::npos) << entry.type_name << ": no comments";
    for (std::sregex_iterator it(text.begin(), text.end(), mention), end; it != end; ++it) {
      const std::regex definition("(struct|enum|const long) +" + (*it)[1].str() + "\\b");
      EXPECT_TRUE(std::regex_search(text, definition)) << entry.type_name << " uses " << it->str();
    }
  }
}

}  // namespace
}  // namespace baton::dds
