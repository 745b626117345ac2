/// Publishes the messages of a recording as raw bytes, each writer's by a writer of its own, spaced as they were
/// logged.
///
/// One thread reads, waits and writes; deadlines are absolute on the steady clock, so delays do not add up. Signals
/// only set a flag that every wait looks at.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dds/endpoint.hpp"
#include "dds/typed.hpp"
#include "lateness.hpp"
#include "mcap/reader.hpp"
#include "options.hpp"

namespace baton {

struct ReplayResult {
  bool was_interrupted = false;
  std::uint64_t messages = 0;
  std::uint64_t total = 0;  // that could be read and were asked for
  std::size_t writers = 0;
  std::size_t topics = 0;
  double recorded_s = 0.0;  // log time from the first to the last message that was sent
  double elapsed_s = 0.0;   // the same on the wall clock
  Lateness lateness;        // behind the deadline when DDS had the message; zeros at the highest rate, which has none
  std::vector<std::string> problems;  // what of the recording could not be replayed, and why
};

/// 0, or 1 when there were problems, or 130.
[[nodiscard]] ExitCode exitCode(const ReplayResult& result);

class Replayer {
 public:
  /// Opens the recording and makes the writers. Throws FormatError when it is not one, UsageError for topics it does
  /// not have, and UnavailableError when the file, DDS or the run is not to be had.
  explicit Replayer(const ReplayOptions& options);
  Replayer(const Replayer&) = delete;
  Replayer& operator=(const Replayer&) = delete;

  /// Sends everything, or as much as Ctrl-C and SIGTERM allow, and waits until the readers have it.
  [[nodiscard]] ReplayResult run();

 private:
  void noteDamage(const mcap::Damage& damage);
  void noteProblem(const std::string& problem);
  void chooseChannels();
  void checkNames() const;
  [[nodiscard]] std::uint64_t countMessages() const;
  void waitForReaders();
  void play();
  [[nodiscard]] bool sleepUntil(std::int64_t deadline_ns);
  void waitForAcknowledgments();
  void reportWhenDue();
  void report(msg::ReplayState state);

  ReplayOptions options_;
  std::set<mcap::ChannelId> deaf_;   // a reader of it does not acknowledge
  std::set<std::uint64_t> damaged_;  // offsets of damage told of
  ReplayResult result_;
  mcap::Reader reader_;
  mcap::MessageFilter filter_;
  dds::Participant participant_;
  dds::Writer<msg::ReplayStatus> status_out_;
  std::map<mcap::ChannelId, dds::RawWriter> writers_;
  std::vector<double> lateness_us_;  // one a message
  std::size_t reported_ = 0;         // of these, in a status
  msg::ReplayState state_ = msg::REPLAY_WAITING;
  std::uint64_t first_log_time_ns_ = 0;  // of what is sent
  std::uint64_t log_time_ns_ = 0;        // of the last message sent
  std::int64_t begin_ns_ = 0;            // steady clock
  std::int64_t next_report_ns_ = 0;
  bool has_progress_line_ = false;
};

}  // namespace baton
