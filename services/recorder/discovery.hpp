/// The topics of the cell, found as their writers appear, each read as raw bytes: no type is known here. A topic that
/// is left out is read only where the run waits for the recorder to listen.
///
/// On the topics of a run only those are recorded who are heard there; topics of other programs are anybody's.
///
/// Readers are made on the executor; who writes what is noted where discovery tells of it, before a sample can come.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "dds/endpoint.hpp"
#include "mcap/records.hpp"
#include "runtime/service.hpp"
#include "topic_selection.hpp"

namespace baton {

class TopicReaders {
 public:
  /// On a DDS thread. @param topic  the place of the topic, for of().
  using Sink = std::function<void(std::uint32_t topic, const dds::RawSample& sample)>;

  /// @param own  the recorder itself, whose topics are not recorded: writing them would change them.
  TopicReaders(Service& service, TopicSelection selection, dds::GuidPrefix own, Sink sink);
  ~TopicReaders();
  TopicReaders(const TopicReaders&) = delete;
  TopicReaders& operator=(const TopicReaders&) = delete;

  /// Begins to watch. Once.
  void watch();

  struct Writer {
    std::string topic;
    std::string type;
    bool is_recorded = true;
    bool lasts = false;
    mcap::StringMap metadata;  // of its channel
  };
  /// Who is behind a sample; any thread.
  [[nodiscard]] Writer of(std::uint32_t topic, const dds::Guid& writer) const;
  /// What has been left out so far, by name; patterns of the selection that nothing has matched so far; and writers
  /// that could not be read, in a sentence each. Any thread.
  [[nodiscard]] std::vector<std::string> leftOut() const;
  [[nodiscard]] std::vector<std::string> unmatched() const;
  [[nodiscard]] std::vector<std::string> unreadable() const;

 private:
  struct Topic {
    dds::EndpointOptions options;
    std::unique_ptr<dds::RawReader> reader;
  };

  [[nodiscard]] bool isWanted(const dds::DiscoveredWriter& writer);
  void noteWriter(const dds::DiscoveredWriter& writer);
  void writerFound(const dds::DiscoveredWriter& writer);
  [[nodiscard]] bool isOurs(const dds::DiscoveredWriter& writer) const;
  [[nodiscard]] bool isFor(std::uint32_t topic, const dds::Guid& writer);
  void requireServices();

  Service& service_;
  TopicSelection selection_;
  dds::GuidPrefix own_;
  Sink sink_;
  std::set<std::string> awaited_;  // topics of which the run waits until the recorder reads them

  mutable std::mutex topics_mutex_;
  std::vector<std::unique_ptr<Topic>> topics_;

  // Never held while DDS is asked for something: discovery takes it with DDS's own locks held.
  mutable std::mutex facts_mutex_;
  std::map<dds::Guid, mcap::StringMap> metadata_;  // noted when it is found: who asks something leaves soon
  std::set<std::string> found_;                    // topics, recorded or not
  std::set<std::string> unreadable_;

  // A reader hears writers of a stronger QoS as well: of two on a topic, each takes its own.
  std::atomic<bool> has_rivals_{false};
  std::mutex routes_mutex_;
  std::map<dds::Guid, std::uint32_t> routes_;
};

}  // namespace baton
