// The layout for Foxglove and Lichtblick: every panel it places is there, and every path it plots leads to a member of
// the type that the recordings carry.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <string>

#include "dds/topics.hpp"
#include "msg/idl_text.hpp"
#include "support/processes.hpp"
#include "whatif/command_file.hpp"

namespace baton::test {
namespace {

/// A member of a struct as its IDL text declares it.
struct Member {
  std::string type;      // of one entry, without its module: "double", "string<32>", "Quaternion"
  std::size_t most = 0;  // entries of a list; 0: it is none
};

/// The members of a struct, by name; empty when there is no such struct.
std::map<std::string, Member> membersOf(const std::string& type) {
  std::map<std::string, Member> members;
  for (const msg::IdlText& one : msg::allIdlTexts()) {
    if (one.type_name != type && one.type_name != "baton::msg::" + type) continue;
    const std::string text(one.text), name = type.substr(type.rfind(':') + 1);
    std::smatch body, bound;
    if (!std::regex_search(text, body, std::regex("struct\\s+" + name + "\\s*\\{([^}]*)\\}"))) return {};
    const std::string declarations = body[1];
    const std::regex member(R"(([\w:]+(?:\s+long)*(?:\s*<[^;]*>)?)\s+(\w+)\s*(?:\[(\d+)\])?\s*;)");
    for (std::sregex_iterator at(declarations.begin(), declarations.end(), member), end; at != end; ++at) {
      Member found{(*at)[1], (*at)[3].matched ? std::stoul((*at)[3]) : 0};
      if (std::regex_match(found.type, bound, std::regex(R"(sequence<\s*([^,]+?)\s*,\s*(\d+)\s*>)"))) {
        found = {bound[1], std::stoul(bound[2])};
      }
      if (found.type.starts_with("baton::msg::")) found.type.erase(0, std::string("baton::msg::").size());
      members[(*at)[2]] = found;
    }
    return members;
  }
  return {};
}

/// The type of what is said on a topic; empty for a topic that nobody knows.
std::string typeOf(const std::string& topic) {
  static const std::map<std::string, std::string> types = [] {
    std::map<std::string, std::string> all{{CommandFile::kTopic, CommandFile::kType}};
    const auto add = [&](const auto&... topics) { (all.emplace(topics.name, topics.type), ...); };
    using namespace dds::topics;
    add(kPlantState, kContact, kReference, kJointCommand, kShadowCommand, kSimStatus, kEvent, kSwapOutcome, kSwapReport,
        kBatonStatus, kControllerStatus, kDecision);
    return all;
  }();
  const auto found = types.find(topic);
  return found == types.end() ? "" : found->second;
}

/// The type that a path "topic.member[0].member" leads to; nothing when it leads nowhere.
std::optional<std::string> leadsTo(const std::string& path) {
  std::smatch split;
  if (!std::regex_match(path, split, std::regex(R"((\w+)((?:\.\w+(?:\[\d+\])?)*))"))) return std::nullopt;
  std::string type = typeOf(split[1]);
  if (type.empty()) return std::nullopt;
  const std::string rest = split[2];
  const std::regex part(R"(\.(\w+)(?:\[(\d+)\])?)");
  for (std::sregex_iterator at(rest.begin(), rest.end(), part), end; at != end; ++at) {
    const auto members = membersOf(type);
    const auto found = members.find((*at)[1]);
    if (found == members.end()) return std::nullopt;
    const bool has_index = (*at)[2].matched;
    if (has_index != (found->second.most > 0)) return std::nullopt;
    if (has_index && std::stoul((*at)[2]) >= found->second.most) return std::nullopt;
    type = found->second.type;
  }
  return type;
}

nlohmann::json layout() { return nlohmann::json::parse(std::ifstream(deployFolder() / "foxglove/arm.json")); }

/// The panels in a tree of splits.
void collectPanels(const nlohmann::json& node, std::multiset<std::string>& panels) {
  if (node.is_string()) {
    panels.insert(node.get<std::string>());
    return;
  }
  EXPECT_TRUE(node.at("direction") == "row" || node.at("direction") == "column") << node;
  EXPECT_GT(node.at("splitPercentage"), 0) << node;
  EXPECT_LT(node.at("splitPercentage"), 100) << node;
  collectPanels(node.at("first"), panels);
  collectPanels(node.at("second"), panels);
}

TEST(FoxgloveLayout, PlacesEveryPanelOnce) {
  const nlohmann::json file = layout();
  for (const char* key : {"globalVariables", "userNodes", "playbackConfig"}) EXPECT_TRUE(file.at(key).is_object());
  std::multiset<std::string> placed, configured;
  collectPanels(file.at("layout"), placed);
  for (const auto& [name, config] : file.at("configById").items()) configured.insert(name);
  EXPECT_EQ(placed, configured);
}

TEST(FoxgloveLayout, EveryPathLeadsToAMember) {
  std::set<std::string> topics;
  const nlohmann::json file = layout();
  for (const auto& [name, config] : file.at("configById").items()) {
    SCOPED_TRACE(name);
    const std::string panel = name.substr(0, name.find('!'));
    if (panel == "RawMessages") {
      EXPECT_NE(leadsTo(config.at("topicPath")), std::nullopt) << config.at("topicPath");
      continue;
    }
    ASSERT_TRUE(panel == "Plot" || panel == "StateTransitions");
    EXPECT_FALSE(config.at("paths").empty());
    for (const auto& path : config.at("paths")) {
      const std::string value = path.at("value");
      EXPECT_EQ(path.at("timestampMethod"), "receiveTime");
      EXPECT_FALSE(path.at("label").get<std::string>().empty());
      const std::optional<std::string> type = leadsTo(value);
      ASSERT_NE(type, std::nullopt) << value;
      // Numbers are plotted; of names, words and enumerations one sees when they change.
      EXPECT_EQ(*type == "double", panel == "Plot") << value << " is " << *type;
      EXPECT_EQ(membersOf(*type).size(), 0U) << value << " is a struct";
      topics.insert(value.substr(0, value.find('.')));
    }
  }
  EXPECT_EQ(topics,
            (std::set<std::string>{"contact", "event", "plant_state", "reference", "sim_status", "whatif_command"}));
}

TEST(FoxgloveLayout, APathThatLeadsNowhereIsNoticed) {
  EXPECT_EQ(leadsTo("plant_state.tip_orientation.w"), "double");
  EXPECT_EQ(leadsTo("plant_state.step"), "unsigned long long");
  for (const char* path : {"plant_stat.position[0]", "plant_state.positions[0]", "plant_state.position",
                           "plant_state.position[8]", "plant_state.tip_position[3]", "plant_state.holder[0]",
                           "plant_state.tip_orientation.q", "plant_state.position[0].x", "plant_state position"}) {
    EXPECT_EQ(leadsTo(path), std::nullopt) << path;
  }
}

}  // namespace
}  // namespace baton::test
