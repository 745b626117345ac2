#include "runtime/latched.hpp"

#include <algorithm>
#include <sstream>

#include "dds/history.hpp"
#include "dds/topics.hpp"
#include "mcap/lookup.hpp"
#include "runtime/recorded_qos.hpp"
#include "runtime/recorded_types.hpp"
#include "schema/instance.hpp"

namespace baton {
namespace {

constexpr std::size_t kKeepAll = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kMostBytes = std::size_t{256} << 20;

/// By the QoS that rosbag2 records, of all the publishers that share a channel: "- history: 1", "  depth: 5", ..., in
/// numbers or in words.
std::size_t depthOfOffers(const std::string& profiles) {
  std::size_t sum = 0;
  std::map<std::string, std::string> offer;
  const auto count = [&] {
    const std::string durability = mcap::valueOf(offer, "durability"), history = mcap::valueOf(offer, "history");
    const bool lasts = durability == "1" || durability == "transient_local";
    const bool keeps_all = history == "2" || history == "keep_all";
    if (lasts && sum != kKeepAll) {
      sum = keeps_all ? kKeepAll : sum + std::max<std::size_t>(1, recordedNumber<std::uint32_t>(offer, "depth"));
    }
    offer.clear();
  };
  std::istringstream lines(profiles);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" -"), colon = line.find(": ");
    if (line.starts_with("- ")) count();
    if (begin == std::string::npos || colon == std::string::npos || colon < begin) continue;
    // Those of durations within a policy are deeper, and of other names.
    offer.try_emplace(line.substr(begin, colon - begin), line.substr(colon + 2));
  }
  count();
  return sum;
}

}  // namespace

std::size_t latchedDepth(const std::string& topic, const mcap::StringMap& metadata) {
  const std::map<std::string, std::string> qos = recordedQos(metadata);
  const std::string durability = mcap::valueOf(qos, "durability");
  if (const dds::TopicFacts* facts = dds::topics::called(topic); facts != nullptr && durability != "volatile") {
    return dds::latchedDepth(facts->profile);
  }
  if (durability == "transient_local") {
    if (mcap::valueOf(qos, "history") == "keep_all") return kKeepAll;
    return std::max<std::size_t>(1, recordedNumber<std::uint32_t>(qos, "depth"));
  }
  return depthOfOffers(mcap::valueOf(metadata, "offered_qos_profiles"));
}

std::vector<LatchedMessage> latchedBefore(const mcap::Source& reader, const mcap::MessageFilter& filter) {
  if (filter.start_time_ns <= reader.statistics().start_time_ns) return {};
  mcap::MessageFilter before{.end_time_ns = filter.start_time_ns - 1};
  std::map<mcap::ChannelId, std::size_t> depths;
  for (const auto& [id, channel] : reader.channels()) {
    const bool is_chosen = (filter.channels.empty() && filter.topics.empty()) ||
                           std::ranges::count(filter.channels, id) > 0 ||
                           std::ranges::count(filter.topics, channel.topic) > 0;
    const std::size_t depth = is_chosen ? latchedDepth(channel.topic, channel.metadata) : 0;
    if (depth == 0) continue;
    depths[id] = depth;
    before.channels.push_back(id);
  }
  if (depths.empty()) return {};  // an empty filter would be all
  RecordedTypes types([](const std::string&) {});
  LatchedSamples<mcap::MessageView> latched(kMostBytes);
  reader.forEachMessage(before, [&](const mcap::MessageView& message) {
    const schema::Type* type = types.typeOf(message);
    const std::string instance = type == nullptr ? "" : schema::instanceOf(*type, message.data);
    const mcap::ChannelId id = message.channel->id;
    latched.keep(static_cast<std::size_t>(id), instance, depths.at(id), message, message.data);
  });
  std::vector<LatchedMessage> result;
  latched.forEach([&](const auto& sample) { result.push_back({sample.head, sample.bytes}); });
  for (LatchedMessage& one : result) one.view.data = one.bytes;
  return result;
}

}  // namespace baton
