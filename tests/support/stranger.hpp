/// A process that is in the run's partition and has not its key: what any user of the machine can start.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dds/fastdds.hpp"
#include "dds/participant_impl.hpp"
#include "dds/qos.hpp"
#include "dds/typed.hpp"
#include "runtime/service_options.hpp"

namespace baton::test {

class Stranger {
 public:
  /// @param claims  the service that it says it is.  @param place  of which run it is in the partition; "*": of all.
  /// @param key  of the run: with it this is no stranger, and shows what would come of what it says.
  Stranger(int domain, const std::string& run, const std::string& claims, const std::string& place = "",
           const std::optional<dds::RunKey>& key = {})
      : participant_({.domain = domain,
                      .partition = "lab/" + (place.empty() ? run : place),
                      .cell = "lab",
                      .run = run,
                      .service = claims,
                      .role = roleCalled(claims),
                      .key = key}) {}

  /// On a writer that is made when it is first used: what comes before it is matched is heard by nobody.
  template <class T>
  void say(const dds::Topic<T>& topic, const T& message) {
    std::vector<std::byte> room(dds::maxPayload<T>());
    write(dds::endpointOptions(topic), dds::encode(message, std::span(room)));
    speaks_baton_ = true;
  }
  void sayRaw(const std::string& topic, const std::string& type, std::span<const std::byte> payload) {
    sayWith({.topic = topic, .type = type, .profile = dds::Profile::kLoop}, payload);
  }
  void sayWith(const dds::EndpointOptions& options, std::span<const std::byte> payload) { write(options, payload); }
  /// Bytes in place of a message, with a time stamp of its own choice.
  void sayBytes(const dds::TopicFacts& topic, std::span<const std::byte> payload,
                std::optional<std::int64_t> source_timestamp_ns = {}) {
    write({.topic = topic.name, .type = topic.type, .profile = topic.profile, .max_payload = 1 << 20}, payload,
          source_timestamp_ns);
    speaks_baton_ = true;
  }
  /// Does something on a thread of its own, one thing at a time: DDS holds locks while it calls back. What comes
  /// meanwhile is left out.
  void aside(std::function<void()> what) {
    if (aside_.valid() && aside_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    aside_ = std::async(std::launch::async, std::move(what));
  }
  /// Readers of a topic that have room for one sample and never take it: they ask for what they have no room for as
  /// often as the writer asks them.
  void refuseAll(const dds::TopicFacts& topic, std::size_t readers) {
    using namespace fastdds::dds;
    dds::Participant::Impl& dds = participant_.impl();
    Topic* const shared = dds.topic(topic.name, topic.type, 1024, false);
    DataReaderQos qos = dds.subscriber->get_default_datareader_qos();
    dds::applyProfile(topic.profile, qos);
    qos.history().kind = KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples = 1;
    qos.resource_limits().max_instances = 1;
    qos.resource_limits().max_samples_per_instance = 1;
    qos.resource_limits().allocated_samples = 1;
    while (refusing_++ < readers) dds.subscriber->create_datareader(shared, qos);
  }
  /// The services that read what it says there.
  [[nodiscard]] std::set<std::string> readersOf(const std::string& topic) const {
    std::set<std::string> services;
    for (const dds::GuidPrefix& prefix : writers_.at(topic)->matched()) {
      if (const auto peer = participant_.peer(prefix)) services.insert(peer->service);
    }
    return services;
  }
  /// Whether all of them have got all that it said there.
  [[nodiscard]] bool hasArrived(const std::string& topic) { return writers_.at(topic)->waitForAcknowledgments(10'000); }
  /// Whether anything it said has a reader: messages that are none of Baton's need not have one.
  [[nodiscard]] bool isHeard() const {
    return !speaks_baton_ ||
           std::ranges::any_of(writers_, [](const auto& one) { return !one.second->matched().empty(); });
  }
  /// It hears itself like anybody else.
  [[nodiscard]] bool hasWritten(const dds::RawSample& sample) const {
    return dds::prefixOf(sample.writer) == participant_.self().prefix;
  }
  [[nodiscard]] dds::Participant& participant() { return participant_; }

 private:
  void write(const dds::EndpointOptions& options, std::span<const std::byte> payload,
             std::optional<std::int64_t> source_timestamp_ns = {}) {
    auto& writer = writers_[options.topic];
    if (!writer) writer = std::make_unique<dds::RawWriter>(participant_, options);
    // An attack that DDS refuses is none: the tests see by its effects whether it was one.
    static_cast<void>(source_timestamp_ns ? writer->write(payload, *source_timestamp_ns) : writer->write(payload));
  }

  dds::Participant participant_;
  std::map<std::string, std::unique_ptr<dds::RawWriter>> writers_;
  bool speaks_baton_ = false;
  std::size_t refusing_ = 0;
  std::future<void> aside_;
};

}  // namespace baton::test
