#include "discovery.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>

#include "base/error.hpp"
#include "dds/topics.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxFound = 10'000;  // names of topics: strangers must not fill the memory

/// What eProsima's DDS Record & Replay keeps of a writer's QoS, and reads: whoever stands in for it must share these.
std::string qosYaml(const dds::DiscoveredWriter& writer) {
  const auto word = [](bool value) { return value ? "true" : "false"; };
  return std::string("reliability: ") + word(writer.reliable) + "\ndurability: " + word(writer.transient_local) +
         "\nownership: " + word(writer.exclusive_ownership) + "\nkeyed: " + word(writer.keyed) + "\n";
}

}  // namespace

TopicReaders::TopicReaders(dds::Participant& participant, boost::asio::io_context& executor, ReadingRules rules,
                           Sink sink)
    : participant_(participant), executor_(executor), rules_(std::move(rules)), sink_(std::move(sink)) {
  places_.push_back({.participant = &participant_, .takes_foreign = !rules_.keeps_foreign_apart});
}

TopicReaders::~TopicReaders() {
  stopWatching();   // writers come and go while this one ends
  topics_.clear();  // their callbacks use what is declared after them
}

void TopicReaders::watch() {
  participant_.watchWriters([this](const dds::DiscoveredWriter& writer) {
    if (dds::prefixOf(writer.guid) == participant_.self().prefix || !rules_.is_wanted(writer)) return;
    if (!noteWriter(writer)) return;
    boost::asio::post(executor_, [this, writer] { writerFound(writer); });
  });
}

void TopicReaders::stopWatching() { participant_.watchWriters({}); }

void TopicReaders::refuse(const std::string& topic, const std::string& text) {
  const std::lock_guard lock(facts_mutex_);
  unreadable_.insert({topic, text});
}

bool TopicReaders::isRead(const std::string& topic) const {
  return rules_.selection.isRecorded(topic) || rules_.awaited.contains(topic);
}

/// One more writer of a foreign topic. With the facts' mutex held.
bool TopicReaders::hasPlace() {
  if (foreign_ < rules_.max_foreign_writers) {
    ++foreign_;
    return true;
  }
  const std::string text = "only the first " + std::to_string(rules_.max_foreign_writers) +
                           " writers of topics that are none of Baton's are recorded, and there are more";
  if (unreadable_.insert({"", text}).second) {
    boost::asio::post(executor_, [this, text] { rules_.on_unreadable(text); });
  }
  return false;
}

bool TopicReaders::noteWriter(const dds::DiscoveredWriter& writer) {
  const std::optional<dds::Peer> peer = participant_.member(dds::prefixOf(writer.guid));
  const bool is_foreign = dds::isForeignTopic(writer.topic);
  const std::lock_guard lock(facts_mutex_);
  if (!is_foreign || (rules_.selection.takes_foreign && found_.size() < kMaxFound)) found_.insert(writer.topic);
  if (!isRead(writer.topic)) return false;
  if (is_foreign && !notes_.contains(writer.guid) && !hasPlace()) return false;
  Note& note = notes_[writer.guid];
  if (note.found_ns == 0) note.found_ns = participant_.clock().now();
  note.metadata = {{"writer", dds::toString(writer.guid)},
                   {"service", peer ? peer->service : ""},
                   {"type", writer.type},
                   {"qos", qosYaml(writer)},
                   {"qos_policies", writer.qos_text}};
  return true;
}

void TopicReaders::writerFound(const dds::DiscoveredWriter& writer) {
  const dds::EndpointOptions options{.topic = writer.topic,
                                     .type = writer.type,
                                     .profile = writer.transient_local ? dds::Profile::kEvent : dds::Profile::kLoop,
                                     .keyed = writer.keyed,
                                     .exclusive_ownership = writer.exclusive_ownership,
                                     .best_effort = !writer.reliable,
                                     .any_encoding = true};
  dds::Participant* participant = nullptr;
  try {
    participant = &participantFor(writer);
  } catch (const Error& error) {
    return cannotRead(writer, error);
  }
  const std::lock_guard lock(topics_mutex_);
  const auto known =
      std::find_if(topics_.begin(), topics_.end(), [&](const auto& topic) { return topic->options == options; });
  const auto index = static_cast<std::uint32_t>(known - topics_.begin());
  {
    const std::lock_guard route_lock(routes_mutex_);
    routes_[writer.guid] = index;
  }
  if (known != topics_.end()) return;
  if (std::any_of(topics_.begin(), topics_.end(),
                  [&](const auto& topic) { return topic->options.topic == writer.topic; }))
    has_rivals_ = true;
  auto topic = std::make_unique<Topic>();
  topic->options = options;
  try {
    topic->reader = std::make_unique<dds::RawReader>(
        *participant, options,
        [this, index, is_foreign = dds::isForeignTopic(writer.topic)](const dds::RawSample& sample) {
          if (dds::prefixOf(sample.writer) == participant_.self().prefix || !isFor(index, sample.writer)) return;
          if (is_foreign && !isNoted(sample.writer)) return;
          sink_(index, is_foreign, sample);
        },
        [this] {
          if (rules_.on_match) rules_.on_match();
        },
        rules_.filter_for(writer.topic));
  } catch (const Error& error) {
    return cannotRead(writer, error);
  }
  topics_.push_back(std::move(topic));
}

void TopicReaders::cannotRead(const dds::DiscoveredWriter& writer, const Error& error) {
  refuse(writer.topic, "a writer cannot be recorded: " + std::string(error.what()));
  rules_.on_unreadable(error.what());
}

bool TopicReaders::Place::takes(const dds::DiscoveredWriter& writer) const {
  if (!takes_foreign && dds::isForeignTopic(writer.topic)) return false;
  const auto type = types.find(writer.topic);
  const auto keyed = is_keyed.find(writer.type);
  return (type == types.end() || type->second == writer.type) &&
         (keyed == is_keyed.end() || keyed->second == writer.keyed);
}

/// One that has no room for it says what is the matter.
dds::Participant& TopicReaders::participantFor(const dds::DiscoveredWriter& writer) {
  auto place = std::ranges::find_if(places_, [&](const Place& one) { return one.takes(writer); });
  if (place == places_.end()) {
    if (places_.size() == rules_.max_participants) return *places_.back().participant;
    more_.push_back(rules_.another());
    place = places_.insert(place, {.participant = more_.back().get()});
  }
  place->types.emplace(writer.topic, writer.type);
  place->is_keyed.emplace(writer.type, writer.keyed);
  return *place->participant;
}

bool TopicReaders::isFor(std::uint32_t topic, const dds::Guid& writer) {
  if (!has_rivals_) return true;
  const std::lock_guard lock(routes_mutex_);
  const auto found = routes_.find(writer);
  return found == routes_.end() || found->second == topic;
}

/// DDS matches a reader also with writers that have no place.
bool TopicReaders::isNoted(const dds::Guid& writer) const {
  const std::lock_guard lock(facts_mutex_);
  return notes_.contains(writer);
}

TopicReaders::Writer TopicReaders::of(std::uint32_t topic, const dds::Guid& writer) const {
  Writer result;
  {
    const std::lock_guard lock(topics_mutex_);
    const dds::EndpointOptions& options = topics_[topic]->options;
    result.topic = options.topic;
    result.type = options.type;
    result.lasts = options.profile == dds::Profile::kEvent;
  }
  result.is_recorded = rules_.selection.isRecorded(result.topic);
  {
    const std::lock_guard lock(facts_mutex_);
    if (const auto found = notes_.find(writer); found != notes_.end()) {
      result.found_ns = found->second.found_ns;
      result.metadata = found->second.metadata;
    }
  }
  if (std::string& service = result.metadata["service"]; service.empty()) {
    // Its endpoints may have been known before the process was.
    const dds::GuidPrefix prefix = dds::prefixOf(writer);
    const auto peer = participant_.member(prefix), departed = participant_.departed(prefix);
    if (peer || departed) service = (peer ? peer : departed)->service;
  }
  result.metadata["type"] = result.type;
  result.metadata["writer"] = dds::toString(writer);
  return result;
}

std::set<dds::GuidPrefix> TopicReaders::matched(const std::string& topic) const {
  const std::lock_guard lock(topics_mutex_);
  std::set<dds::GuidPrefix> result;
  for (const auto& known : topics_) {
    if (known->options.topic == topic) result.merge(known->reader->matched());
  }
  return result;
}

std::vector<std::string> TopicReaders::leftOut() const {
  const std::lock_guard lock(facts_mutex_);
  std::vector<std::string> result;
  for (const std::string& topic : found_) {
    if (!rules_.selection.isRecorded(topic)) result.push_back(topic);
  }
  return result;
}

std::vector<std::string> TopicReaders::unmatched() const {
  const std::lock_guard lock(facts_mutex_);
  return rules_.selection.unmatched(found_);
}

std::vector<TopicReaders::Unreadable> TopicReaders::unreadable() const {
  const std::lock_guard lock(facts_mutex_);
  return {unreadable_.begin(), unreadable_.end()};
}

std::vector<std::string> TopicReaders::unmatchedWriters(std::chrono::nanoseconds patience) const {
  const std::int64_t latest_ns = participant_.clock().now() - patience.count();
  std::vector<std::string> result;
  for (const dds::DiscoveredWriter& writer : participant_.writers()) {
    const dds::GuidPrefix prefix = dds::prefixOf(writer.guid);
    if (prefix == participant_.self().prefix || !rules_.selection.isRecorded(writer.topic)) continue;
    {
      const std::lock_guard lock(facts_mutex_);
      const auto found = notes_.find(writer.guid);
      if (found == notes_.end() || found->second.found_ns > latest_ns) continue;
    }
    if (matched(writer.topic).contains(prefix)) continue;
    result.push_back(writer.topic + " of " + dds::toString(writer.guid) +
                     ": its writer is there and has not been matched (its QoS: " + writer.qos_text + ")");
  }
  return result;
}

}  // namespace baton
