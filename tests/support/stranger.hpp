/// A process that is in the run's partition and has not its key: what any user of the machine can start.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

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
    auto& writer = writers_[topic.name];
    if (!writer) writer = std::make_shared<dds::Writer<T>>(participant_, topic);
    static_cast<dds::Writer<T>*>(writer.get())->write(message);
    if (!static_cast<dds::Writer<T>*>(writer.get())->raw().matched().empty()) is_heard_ = true;
  }
  void sayRaw(const std::string& topic, const std::string& type, std::span<const std::byte> payload) {
    auto& writer = raw_[topic];
    if (!writer) {
      writer = std::make_unique<dds::RawWriter>(
          participant_, dds::EndpointOptions{.topic = topic, .type = type, .profile = dds::Profile::kLoop});
    }
    if (writer->write(payload)) is_heard_ = true;
  }
  /// Whether anything it said had a reader.
  [[nodiscard]] bool isHeard() const { return is_heard_; }
  /// It hears itself like anybody else.
  [[nodiscard]] bool hasWritten(const dds::RawSample& sample) const {
    return dds::prefixOf(sample.writer) == participant_.self().prefix;
  }
  [[nodiscard]] dds::Participant& participant() { return participant_; }

 private:
  dds::Participant participant_;
  std::map<std::string, std::shared_ptr<void>> writers_;
  std::map<std::string, std::unique_ptr<dds::RawWriter>> raw_;
  bool is_heard_ = false;
};

}  // namespace baton::test
