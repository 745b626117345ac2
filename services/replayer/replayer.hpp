/// Publishes the messages of a recording as raw bytes, each writer's by a writer of its own, spaced as they were
/// logged. Playlist says what, Playback when, Outlet sends; this is the loop that joins them, and carries out what is
/// asked for from elsewhere and by keys.
///
/// One thread does all of it; deadlines are absolute on the steady clock, so delays do not add up. Requests, keys and
/// signals end its sleep.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "audience.hpp"
#include "base/error.hpp"
#include "options.hpp"
#include "outlet.hpp"
#include "own_key.hpp"
#include "playback.hpp"
#include "playlist.hpp"
#include "remote.hpp"
#include "runtime/admission.hpp"
#include "runtime/progress_line.hpp"
#include "sleeper.hpp"
#include "terminal.hpp"
#include "time/histogram.hpp"

namespace baton {

struct ReplayResult {
  bool was_interrupted = false;
  bool was_stopped = false;  // by request
  std::uint64_t messages = 0;
  std::uint64_t total = 0;  // of one pass, that could be read and were asked for
  std::uint32_t passes = 0;
  std::size_t writers = 0;
  std::size_t topics = 0;
  double recorded_s = 0.0;            // log time that was played
  double elapsed_s = 0.0;             // the same on the wall clock, pauses included
  Histogram lateness_ns;              // behind the deadline when DDS had the message; of those that had one
  std::uint64_t overdue = 0;          // later than asked for
  std::vector<std::string> problems;  // what of the recording could not be replayed as it was, and why
  std::vector<std::string> notes;     // of readers nobody asked for
};

/// 0, or 1 when there were problems, or 130.
[[nodiscard]] ExitCode exitCode(const ReplayResult& result);

class Replayer {
 public:
  /// Opens the recording and makes the writers. Throws as Playlist does, and UnavailableError when DDS or the run is
  /// not to be had.
  explicit Replayer(const ReplayOptions& options);
  Replayer(const Replayer&) = delete;
  Replayer& operator=(const Replayer&) = delete;

  /// Sends everything, or as much as operators, keys, Ctrl-C and SIGTERM allow, and waits until the readers have it.
  [[nodiscard]] ReplayResult run();

 private:
  // replayer.cpp: the loop
  void waitForReaders();
  void play();
  [[nodiscard]] bool goOnAtEnd();
  void fetch();
  void send(const Playback::Due& due);
  void noteLateness(std::int64_t late_ns);
  [[nodiscard]] bool mustEnd() const { return playback_.isStopped() || isInterrupted(); }
  void sleepUntil(std::int64_t deadline_ns);
  void reportBefore(std::int64_t deadline_ns);
  void finish();

  // replayer_control.cpp: what is asked for, and how it stands
  void serve();
  void obey(const msg::ReplayRequest& request);
  [[nodiscard]] std::string refusalOf(const msg::ReplayRequest& request) const;
  [[nodiscard]] std::string objectionTo(const std::string& topic) const;
  void seek(std::uint64_t position_ns);
  void endStep(const std::string& why_short);
  void answer(std::uint64_t request_id, const std::string& refusal);
  void obey(Key key);
  void report();
  [[nodiscard]] msg::ReplayState state() const;
  [[nodiscard]] std::uint64_t position() const;
  void showProgress(msg::ReplayState state);

  ReplayOptions options_;
  Sleeper sleeper_;
  Playlist playlist_;
  Playback playback_;
  OwnKey own_key_;
  dds::Participant participant_;
  Admission admission_;  // of requests
  Outlet outlet_;
  Remote remote_;
  ReplayResult result_;
  std::optional<mcap::MessageView> next_;  // nothing at the end
  enum class Phase { kWaiting, kPlaying, kOver } phase_ = Phase::kWaiting;
  std::string waits_for_;
  std::optional<msg::ReplayRequest> step_;  // under way, to be answered when it is done
  std::int64_t begin_ns_ = 0;
  std::int64_t next_report_ns_ = 0;
  std::optional<Terminal> terminal_;
  std::optional<ProgressLine> progress_;
};

}  // namespace baton
