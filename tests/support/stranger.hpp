/// A process that is in the run's partition and has not its key: what any user of the machine can start.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "dds/typed.hpp"

namespace baton::test {

class Stranger {
 public:
  /// @param claims  the service that it says it is.  @param place  of which run it is in the partition; "*": of all.
  Stranger(int domain, const std::string& run, const std::string& claims, const std::string& place = "")
      : participant_({.domain = domain,
                      .partition = "lab/" + (place.empty() ? run : place),
                      .cell = "lab",
                      .run = run,
                      .service = claims}) {}

  /// On a writer that is made when it is first used: what comes before it is matched is heard by nobody.
  template <class T>
  void say(const dds::Topic<T>& topic, const T& message) {
    std::vector<std::byte> room(dds::maxPayload<T>());
    write(dds::endpointOptions(topic), dds::encode(message, std::span(room)));
    speaks_baton_ = true;
  }
  void sayRaw(const std::string& topic, const std::string& type, std::span<const std::byte> payload) {
    write({.topic = topic, .type = type, .profile = dds::Profile::kLoop}, payload);
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
  void write(const dds::EndpointOptions& options, std::span<const std::byte> payload) {
    auto& writer = writers_[options.topic];
    if (!writer) writer = std::make_unique<dds::RawWriter>(participant_, options);
    // An attack that DDS refuses is none: the tests see by its effects whether it was one.
    static_cast<void>(writer->write(payload));
  }

  dds::Participant participant_;
  std::map<std::string, std::unique_ptr<dds::RawWriter>> writers_;
  bool speaks_baton_ = false;
};

}  // namespace baton::test
