#include "runtime/latched.hpp"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "dds/codec.hpp"
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

/// The take that a message says it is of; nothing when it is no such message.
template <class T>
std::optional<std::uint32_t> takeIn(const dds::Topic<T>&, mcap::ByteView bytes) {
  T message;
  return dds::decode(bytes, message) ? std::optional(message.take()) : std::nullopt;
}

bool is(const dds::TopicFacts* topic, const dds::TopicFacts& one) {
  return topic != nullptr && std::string_view(topic->name) == one.name;
}

}  // namespace

std::size_t latchedDepth(const std::string& topic, const mcap::StringMap& metadata) {
  const std::map<std::string, std::string> qos = recordedQos(metadata);
  const std::string durability = mcap::valueOf(qos, "durability");
  if (announcesReset(batonTopic(topic, metadata))) return 1;
  if (const dds::TopicFacts* facts = dds::topics::called(topic); facts != nullptr && durability != "volatile") {
    // Whoever asks leaves soon after, and the request with it. What was launched, only its request says.
    const bool has_left = facts->profile == dds::Profile::kRequest && !is(facts, dds::topics::kLaunchRequest);
    return has_left ? 0 : dds::latchedDepth(facts->profile);
  }
  if (durability == "transient_local") {
    if (mcap::valueOf(qos, "history") == "keep_all") return kKeepAll;
    return std::max<std::size_t>(1, recordedNumber<std::uint32_t>(qos, "depth"));
  }
  // A latching publisher of ROS 1 keeps its last message; converted bags have a channel for each publisher.
  const std::string latching = mcap::valueOf(metadata, "latching");
  if (latching == "1" || latching == "true") return 1;
  return depthOfOffers(mcap::valueOf(metadata, "offered_qos_profiles"));
}

const dds::TopicFacts* batonTopic(const std::string& topic, const mcap::StringMap& metadata) {
  const dds::TopicFacts* facts = dds::topics::called(topic);
  return facts != nullptr && mcap::valueOf(metadata, "type") == facts->type ? facts : nullptr;
}

bool announcesReset(const dds::TopicFacts* topic) { return is(topic, dds::topics::kRewind); }

std::optional<std::uint32_t> takeBegunBy(const dds::TopicFacts* topic, mcap::ByteView bytes) {
  msg::Rewind rewind;
  const bool is_commit = announcesReset(topic) && dds::decode(bytes, rewind) && rewind.phase() == msg::REWIND_COMMIT;
  return is_commit ? std::optional(rewind.take()) : std::nullopt;
}

bool isOfTakeBefore(std::uint32_t take, const dds::TopicFacts* topic, mcap::ByteView bytes) {
  namespace topics = dds::topics;
  // The plant plans nothing for a take before all have acknowledged that it has begun.
  if (announcesReset(topic) || is(topic, topics::kSwapPlan) || is(topic, topics::kSwapAck)) return true;
  // What is decided at its first step may come before the word of its beginning, from another writer.
  const std::optional<std::uint32_t> own = is(topic, topics::kDecision)      ? takeIn(topics::kDecision, bytes)
                                           : is(topic, topics::kSwapOutcome) ? takeIn(topics::kSwapOutcome, bytes)
                                           : is(topic, topics::kSwapReport)  ? takeIn(topics::kSwapReport, bytes)
                                                                             : std::nullopt;
  return own && *own < take;
}

std::vector<LatchedMessage> latchedBefore(const mcap::Source& reader, const mcap::MessageFilter& filter) {
  if (filter.start_time_ns <= reader.statistics().start_time_ns) return {};
  mcap::MessageFilter before{.end_time_ns = filter.start_time_ns - 1};
  struct Topic {
    std::size_t depth = 0;
    const dds::TopicFacts* facts = nullptr;
    bool is_chosen = false;
  };
  std::map<mcap::ChannelId, Topic> topics;
  for (const auto& [id, channel] : reader.channels()) {
    const bool is_chosen = (filter.channels.empty() && filter.topics.empty()) ||
                           std::ranges::count(filter.channels, id) > 0 ||
                           std::ranges::count(filter.topics, channel.topic) > 0;
    const Topic topic{.depth = latchedDepth(channel.topic, channel.metadata),
                      .facts = batonTopic(channel.topic, channel.metadata),
                      .is_chosen = is_chosen};
    // Resets are read in any case: they part what is chosen.
    if (topic.depth == 0 || (!is_chosen && !announcesReset(topic.facts))) continue;
    topics[id] = topic;
    before.channels.push_back(id);
  }
  // An empty filter would be all.
  if (std::ranges::none_of(topics, [](const auto& entry) { return entry.second.is_chosen; })) return {};
  RecordedTypes types([](const std::string&) {});
  LatchedSamples<mcap::MessageView> latched(kMostBytes);
  reader.forEachMessage(before, [&](const mcap::MessageView& message) {
    const schema::Type* type = types.typeOf(message);
    const std::string instance = type == nullptr ? "" : schema::instanceOf(*type, message.data);
    const mcap::ChannelId id = message.channel->id;
    const Topic& topic = topics.at(id);
    latched.keep(static_cast<std::size_t>(id), instance, topic.depth, message, message.data, topic.facts);
  });
  std::vector<LatchedMessage> result;
  latched.forEach([&](const auto& sample) {
    if (topics.at(sample.head.channel->id).is_chosen) result.push_back({sample.head, sample.bytes});
  });
  for (LatchedMessage& one : result) one.view.data = one.bytes;
  return result;
}

}  // namespace baton
