/// Topics, found as their writers appear, each read as raw bytes: no type is known here. Which writers are of concern,
/// and who counts on a topic, is decided by whoever records.
///
/// Readers are made on the executor; who writes what is noted where discovery reports it, before a sample can come.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dds/endpoint.hpp"
#include "mcap/records.hpp"
#include "topic_selection.hpp"

namespace baton {

/// Of all the traffic in a domain, what is read.
struct ReadingRules {
  TopicSelection selection{};
  std::set<std::string> awaited{};  // topics that are read though they are not recorded
  /// Whether a writer is of concern. On a DDS thread.
  std::function<bool(const dds::DiscoveredWriter&)> is_wanted;
  /// Whose samples count on a topic; an empty one: everybody's.
  std::function<dds::WriterFilter(const std::string& topic)> filter_for = [](const std::string&) {
    return dds::WriterFilter{};
  };
  /// Readers are matched with others than before. On a DDS thread.
  std::function<void()> on_match{};
  /// A writer cannot be read, in a sentence. On the executor.
  std::function<void(const std::string& text)> on_unreadable;
  /// Another participant, like the first but for whom it hears: one has room for one type under the name of a topic,
  /// and for a type with a key or without.
  std::function<std::unique_ptr<dds::Participant>()> another;
  /// So many in all; writers for which there is no room in them are unreadable.
  std::size_t max_participants = 8;
  /// Foreign topics, those that are none of Baton's, are not read with the first one.
  bool keeps_foreign_apart = false;
  /// So many writers of foreign topics are read; each costs a channel and memory.
  std::size_t max_foreign_writers = std::numeric_limits<std::size_t>::max();
};

class TopicReaders {
 public:
  /// On a DDS thread. @param topic  the place of the topic, for of().  @param is_foreign  it is none of Baton's.
  using Sink = std::function<void(std::uint32_t topic, bool is_foreign, const dds::RawSample& sample)>;

  /// What the participant itself writes is not recorded: writing it would change it.
  TopicReaders(dds::Participant& participant, boost::asio::io_context& executor, ReadingRules rules, Sink sink);
  ~TopicReaders();
  TopicReaders(const TopicReaders&) = delete;
  TopicReaders& operator=(const TopicReaders&) = delete;

  /// Begins to watch. Once.
  void watch();
  /// No more readers from now on.
  void stopWatching();
  /// A writer of this topic is not read, in a sentence; any thread.
  void refuse(const std::string& topic, const std::string& text);

  struct Writer {
    std::string topic;
    std::string type;
    bool is_recorded = true;
    bool lasts = false;
    std::int64_t found_ns = 0;  // since the epoch, by the participant's clock
    mcap::StringMap metadata;   // of its channel
  };
  /// Who is behind a sample; any thread.
  [[nodiscard]] Writer of(std::uint32_t topic, const dds::Guid& writer) const;
  /// The participants matched with the readers of a topic; any thread.
  [[nodiscard]] std::set<dds::GuidPrefix> matched(const std::string& topic) const;
  /// What has been left out so far, by name; patterns of the selection that nothing has matched so far; and writers
  /// that could not be read, with their topic and in a sentence each. Any thread.
  [[nodiscard]] std::vector<std::string> leftOut() const;
  [[nodiscard]] std::vector<std::string> unmatched() const;
  struct Unreadable {
    std::string topic;
    std::string text;
    auto operator<=>(const Unreadable&) const = default;
  };
  [[nodiscard]] std::vector<Unreadable> unreadable() const;
  /// Writers that are recorded and there, and have not been matched within `patience` of being found: nothing of theirs
  /// can come. In a sentence each; any thread.
  [[nodiscard]] std::vector<std::string> unmatchedWriters(std::chrono::nanoseconds patience) const;

 private:
  struct Topic {
    dds::EndpointOptions options;
    std::unique_ptr<dds::RawReader> reader;
  };
  struct Place {
    dds::Participant* participant = nullptr;
    bool takes_foreign = true;
    std::map<std::string, std::string> types{};  // by topic
    std::map<std::string, bool> is_keyed{};      // by type

    [[nodiscard]] bool takes(const dds::DiscoveredWriter& writer) const;
  };
  struct Note {
    std::int64_t found_ns = 0;
    mcap::StringMap metadata;
  };

  [[nodiscard]] bool isRead(const std::string& topic) const;
  [[nodiscard]] bool noteWriter(const dds::DiscoveredWriter& writer);
  [[nodiscard]] bool hasPlace();
  void writerFound(const dds::DiscoveredWriter& writer);
  void cannotRead(const dds::DiscoveredWriter& writer, const Error& error);
  [[nodiscard]] dds::Participant& participantFor(const dds::DiscoveredWriter& writer);
  [[nodiscard]] bool isFor(std::uint32_t topic, const dds::Guid& writer);
  [[nodiscard]] bool isNoted(const dds::Guid& writer) const;

  dds::Participant& participant_;
  boost::asio::io_context& executor_;
  ReadingRules rules_;
  Sink sink_;
  std::vector<std::unique_ptr<dds::Participant>> more_;  // of rules_.another; outlive the readers
  std::vector<Place> places_;                            // of the executor

  mutable std::mutex topics_mutex_;
  std::vector<std::unique_ptr<Topic>> topics_;

  // Never held while DDS is asked for something: discovery takes it with DDS's own locks held.
  mutable std::mutex facts_mutex_;
  std::map<dds::Guid, Note> notes_;  // made when it is found: who asks something leaves soon
  std::set<std::string> found_;      // topics, recorded or not
  std::size_t foreign_ = 0;          // of the notes, recorded writers of foreign topics
  std::set<Unreadable> unreadable_;

  // A reader hears writers of a stronger QoS as well: of two on a topic, each takes its own.
  std::atomic<bool> has_rivals_{false};
  mutable std::mutex routes_mutex_;
  std::map<dds::Guid, std::uint32_t> routes_;
};

}  // namespace baton
