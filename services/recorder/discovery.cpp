#include "discovery.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <boost/asio/post.hpp>

#include "base/text.hpp"

namespace baton {
namespace {

/// What eProsima's DDS Record & Replay keeps of a writer's QoS, and reads: whoever stands in for it must share these.
std::string qosYaml(const dds::DiscoveredWriter& writer) {
  const auto word = [](bool value) { return value ? "true" : "false"; };
  return std::string("reliability: ") + word(writer.reliable) + "\ndurability: " + word(writer.transient_local) +
         "\nownership: " + word(writer.exclusive_ownership) + "\nkeyed: " + word(writer.keyed) + "\n";
}

}  // namespace

TopicReaders::TopicReaders(Service& service, TopicSelection selection, dds::GuidPrefix own, Sink sink)
    : service_(service), selection_(std::move(selection)), own_(own), sink_(std::move(sink)) {
  requireServices();
}

TopicReaders::~TopicReaders() {
  service_.participant().watchWriters({});  // those of other cells come and go while this one ends
  topics_.clear();                          // their callbacks use what is declared after them
}

void TopicReaders::watch() {
  service_.participant().watchWriters([this](const dds::DiscoveredWriter& writer) {
    if (!isOurs(writer) || dds::prefixOf(writer.guid) == own_ || !isWanted(writer)) return;
    noteWriter(writer);
    boost::asio::post(service_.executor(), [this, writer] { writerFound(writer); });
  });
}

void TopicReaders::requireServices() {
  const Scenario& scenario = service_.scenario();
  const auto require = [this](const std::string& name, const std::vector<std::string>& writers) {
    awaited_.insert(name);
    service_.require(
        name,
        [this, name] {
          const std::lock_guard lock(topics_mutex_);
          std::set<dds::GuidPrefix> matched;
          for (const auto& known : topics_) {
            if (known->options.topic == name) matched.merge(known->reader->matched());
          }
          return matched;
        },
        writers);
  };
  for (const dds::TopicFacts& topic : dds::topics::kAll) {
    switch (topic.recorded_from) {
      case dds::RecordedFrom::kNobody: break;
      case dds::RecordedFrom::kPlant: require(topic.name, {kPlantName}); break;
      case dds::RecordedFrom::kTrajectory: require(topic.name, {kTrajectoryName}); break;
      case dds::RecordedFrom::kEnvironment:
        if (scenario.hasEnvironment()) require(topic.name, {kEnvironmentName});
        break;
      case dds::RecordedFrom::kControllers: require(topic.name, controllerNames(scenario)); break;
      case dds::RecordedFrom::kServices: require(topic.name, servicesBut(kRecorderName, scenario)); break;
    }
  }
  // No writer waits for the recorder to read these; the recorder itself needs what they say.
  for (const char* name :
       {dds::topics::kServiceStatus.name, dds::topics::kParameterStatus.name, dds::topics::kParameterReply.name}) {
    awaited_.insert(name);
  }
}

/// A writer's partition may be a pattern, as DDS has it.
bool TopicReaders::isOurs(const dds::DiscoveredWriter& writer) const {
  const std::string partition = service_.options().participant().partition;
  return std::any_of(writer.partitions.begin(), writer.partitions.end(),
                     [&](const std::string& theirs) { return fnmatch(theirs.c_str(), partition.c_str(), 0) == 0; });
}

bool TopicReaders::isWanted(const dds::DiscoveredWriter& writer) {
  if (hasControlCharacters(writer.topic) || hasControlCharacters(writer.type)) {
    service_.event(msg::SEVERITY_WARNING, "stranger",
                   "a writer of " + dds::toString(writer.guid) +
                       " is not recorded: control characters in the name of its topic or type");
    return false;
  }
  const dds::TopicFacts* facts = dds::topics::called(writer.topic);
  return facts == nullptr || service_.admission().admits(*facts, writer.guid);
}

void TopicReaders::noteWriter(const dds::DiscoveredWriter& writer) {
  const std::optional<dds::Peer> peer = service_.participant().peer(dds::prefixOf(writer.guid));
  const std::lock_guard lock(facts_mutex_);
  metadata_[writer.guid] = {{"writer", dds::toString(writer.guid)},
                            {"service", peer ? peer->service : ""},
                            {"type", writer.type},
                            {"qos", qosYaml(writer)},
                            {"qos_policies", writer.qos_text}};
  found_.insert(writer.topic);
}

void TopicReaders::writerFound(const dds::DiscoveredWriter& writer) {
  if (!selection_.isRecorded(writer.topic) && !awaited_.contains(writer.topic)) return;
  const dds::EndpointOptions options{.topic = writer.topic,
                                     .type = writer.type,
                                     .profile = writer.transient_local ? dds::Profile::kEvent : dds::Profile::kLoop,
                                     .keyed = writer.keyed,
                                     .exclusive_ownership = writer.exclusive_ownership,
                                     .best_effort = !writer.reliable};
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
  const dds::TopicFacts* facts = dds::topics::called(writer.topic);
  try {
    topic->reader = std::make_unique<dds::RawReader>(
        service_.participant(), options,
        [this, index](const dds::RawSample& sample) {
          if (dds::prefixOf(sample.writer) != own_ && isFor(index, sample.writer)) sink_(index, sample);
        },
        [this] { service_.matchesChanged(); },
        facts == nullptr ? dds::WriterFilter{} : service_.admission().filter(*facts));
  } catch (const Error& error) {
    {
      const std::lock_guard facts_lock(facts_mutex_);
      unreadable_.insert("a writer cannot be recorded: " + std::string(error.what()));
    }
    return service_.event(msg::SEVERITY_ERROR, "record", error.what());
  }
  topics_.push_back(std::move(topic));
}

bool TopicReaders::isFor(std::uint32_t topic, const dds::Guid& writer) {
  if (!has_rivals_) return true;
  const std::lock_guard lock(routes_mutex_);
  const auto found = routes_.find(writer);
  return found == routes_.end() || found->second == topic;
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
  result.is_recorded = selection_.isRecorded(result.topic);
  {
    const std::lock_guard lock(facts_mutex_);
    if (const auto found = metadata_.find(writer); found != metadata_.end()) result.metadata = found->second;
  }
  if (std::string& service = result.metadata["service"]; service.empty()) {
    // Its endpoints may have been known before the process was.
    if (const auto peer = service_.participant().peer(dds::prefixOf(writer))) service = peer->service;
  }
  result.metadata["type"] = result.type;
  result.metadata["writer"] = dds::toString(writer);
  return result;
}

std::vector<std::string> TopicReaders::leftOut() const {
  const std::lock_guard lock(facts_mutex_);
  std::vector<std::string> result;
  for (const std::string& topic : found_) {
    if (!selection_.isRecorded(topic)) result.push_back(topic);
  }
  return result;
}

std::vector<std::string> TopicReaders::unmatched() const {
  const std::lock_guard lock(facts_mutex_);
  return selection_.unmatched(found_);
}

std::vector<std::string> TopicReaders::unreadable() const {
  const std::lock_guard lock(facts_mutex_);
  return {unreadable_.begin(), unreadable_.end()};
}

}  // namespace baton
