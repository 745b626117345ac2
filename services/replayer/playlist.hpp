/// What is replayed: the chosen topics of a recording, between two times, message after message in the order of log
/// time. Memory is that of the chunks being read, however long the recording.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dds/endpoint.hpp"
#include "mcap/joined_reader.hpp"
#include "options.hpp"
#include "runtime/latched.hpp"

namespace baton {

class Playlist {
 public:
  /// Opens the recording. A topic that cannot be replayed is left out, and named among the problems. Throws FormatError
  /// when it is not one, UsageError for topics it does not have or when nothing of it can be replayed, and
  /// UnavailableError when the file is not to be had.
  explicit Playlist(const ReplayOptions& options);
  Playlist(const Playlist&) = delete;
  Playlist& operator=(const Playlist&) = delete;

  /// The next message, valid until another is asked for; false at the end.
  [[nodiscard]] bool next(mcap::MessageView& message);
  /// The next message is the first at or after this log time. Reads no more of the file than its chunk.
  void seek(std::uint64_t log_time_ns);
  /// Does without a channel that DDS refuses, from the next seek() or rewind() on. Throws UsageError when no other is
  /// left.
  void leaveOut(mcap::ChannelId id, const std::string& reason);
  /// To the beginning, with what a late joiner would have been given before it.
  void rewind();

  /// The writers that stand in for the recorded ones.
  [[nodiscard]] const std::map<mcap::ChannelId, dds::EndpointOptions>& endpoints() const { return endpoints_; }
  /// Their topics, as they were recorded, sorted.
  [[nodiscard]] std::vector<std::string> topics() const;
  /// Messages from the first to the last time, and those sent before them.
  [[nodiscard]] std::uint64_t total() const { return total_; }
  /// Log time of the recording's first message [ns], and from there to its last one; positions count from the first.
  [[nodiscard]] std::uint64_t startTime() const { return reader_.statistics().start_time_ns; }
  [[nodiscard]] std::uint64_t duration() const;
  /// The part of it that is played, as positions [ns].
  [[nodiscard]] std::uint64_t firstPosition() const;
  [[nodiscard]] std::uint64_t lastPosition() const;
  /// What of the recording cannot be replayed, and why. More may be found on the way.
  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

 private:
  void noteDamage(const std::filesystem::path& file, const mcap::Damage& damage);
  void noteProblem(const std::string& problem);
  void checkNames(const ReplayOptions& options) const;
  void chooseChannels(const ReplayOptions& options);
  void noteLeftOut(const std::string& reason);
  void expectTopics() const;
  [[nodiscard]] std::uint64_t countMessages();

  std::vector<std::string> problems_;
  FoundRecording found_;
  const bool has_range_;
  mcap::JoinedReader reader_;
  RecordingRange range_;
  mcap::MessageFilter filter_;
  std::map<mcap::ChannelId, dds::EndpointOptions> endpoints_;
  std::uint64_t total_ = 0;
  std::optional<mcap::JoinedCursor> cursor_;
  std::vector<LatchedMessage> latched_;  // sent before the first message
  std::size_t next_latched_ = 0;
};

}  // namespace baton
