/// When the messages of a recording go out: the state machine behind pause, resume, step, seek and rate. It is told
/// what is asked for and what has been sent, at times of its caller's steady clock, and looks at no clock itself.
///
/// Recorded time is log time in ns. A message that is held or sought keeps its distance to the place where the replay
/// stands: what was left of the wait for it is waited for afterwards.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "time/pacer.hpp"

namespace baton {

class Playback {
 public:
  struct Plan {
    double rate = 1.0;         // recorded seconds per second; 0: as fast as possible
    std::uint32_t passes = 1;  // through the recording; 0: without end
    bool starts_paused = false;
    std::uint64_t longest_gap_ns = std::numeric_limits<std::uint64_t>::max();  // of log time that is waited for
  };
  explicit Playback(const Plan& plan);

  // What is asked for. Whatever interrupts a step ends it.
  void pause(std::int64_t now_ns);
  void resume(std::int64_t now_ns);
  /// Lets `count` messages of a topic go, and all that come before them, as fast as possible; then holds. An empty
  /// topic counts them all.
  void step(std::uint64_t count, const std::string& topic, std::int64_t now_ns);
  /// Stands at `log_time_ns` from here on; goes on or holds as before.
  void seek(std::uint64_t log_time_ns, std::int64_t now_ns);
  void setRate(double rate, std::int64_t now_ns);
  void stop() { is_stopped_ = true; }

  // What the loop tells and asks.
  /// A pass begins with this message: it is due now.
  void begin(std::uint64_t first_log_time_ns, std::int64_t now_ns);
  struct Due {
    bool is_held = false;                     // not before something is asked for
    std::optional<std::int64_t> deadline_ns;  // nothing: at once
  };
  /// When the next message may go out, which was logged at this time.
  [[nodiscard]] Due due(std::uint64_t log_time_ns);
  /// That message has gone out.
  void sent(const std::string& topic, std::uint64_t log_time_ns, std::int64_t now_ns);
  enum class AtEnd { kAgain, kHold, kOver };
  /// There are no more messages: kAgain begins another pass. What is held at the end stays there, and may be sought
  /// away from it; going on from there ends the replay.
  [[nodiscard]] AtEnd reachEnd();

  [[nodiscard]] bool isStopped() const { return is_stopped_; }
  [[nodiscard]] bool isPlaying() const { return is_playing_; }
  [[nodiscard]] std::uint64_t stepsLeft() const { return steps_left_; }
  [[nodiscard]] double rate() const { return pacer_.rate(); }
  [[nodiscard]] std::uint32_t pass() const { return pass_; }  // from 1
  [[nodiscard]] std::uint32_t passes() const { return plan_.passes; }
  /// Where it stands, in log time.
  [[nodiscard]] std::uint64_t position(std::int64_t now_ns) const;
  /// Log time that has been played [ns], without what was skipped.
  [[nodiscard]] std::uint64_t playedTime() const { return played_ns_; }

 private:
  void hold(std::int64_t now_ns);

  Plan plan_;
  Pacer pacer_;  // its steps are nanoseconds of log time
  bool is_playing_;
  bool is_stopped_ = false;
  std::uint32_t pass_ = 1;
  std::uint64_t steps_left_ = 0;
  std::string step_topic_;
  std::uint64_t head_ns_ = 0;                 // where it stands, or stood when it last did anything
  std::uint64_t next_ns_ = 0;                 // the next message, or the place sought
  std::optional<std::uint64_t> previous_ns_;  // the message before it, unless it was skipped to
  std::uint64_t played_ns_ = 0;
};

}  // namespace baton
