/// The plant's side of the step protocol: which step is open, what it still waits for, and whether it may end. A plain
/// state machine: DDS and clocks only bring it news.
#pragma once

#include <cstdint>

namespace baton {

enum class SimPhase { kStarting, kRunning, kPaused, kFinished, kAborted };

/// What keeps the open step from ending.
enum class Hold {
  kNone,
  kNotStarted,  // the start barrier has not opened
  kEnded,       // the run is over
  kPaused,
  kContact,   // the environment has not answered
  kCommand,   // the holder of the baton has not answered
  kHandover,  // at the step of a swap: the outgoing controller's last command is not here
  kSwap,      // a swap waits to be acknowledged
  kRecorder,  // the recorder is too far behind
  kRewind     // the run is about to go back to its first step
};
[[nodiscard]] const char* toString(Hold hold) noexcept;

struct StepMasterConfig {
  std::uint64_t first_step = 0;  // at which the run begins
  std::uint64_t end_step = 0;    // at which it ends, 0 for never
  bool needs_contact = false;    // there is an environment
  std::uint64_t credit = 0;      // steps the plant may run past what the recorder has; 0: no recorder
};

class StepMaster {
 public:
  explicit StepMaster(const StepMasterConfig& config) noexcept
      : config_(config), step_(config.first_step), acknowledged_(config.first_step) {}

  // --- news
  void start() noexcept;  // the barrier is open: the first step begins
  void pause() noexcept;
  /// Pauses, or ends, when this step opens. Returns false when it is not still to come, or lies after the run's end.
  [[nodiscard]] bool pauseAt(std::uint64_t step) noexcept;
  [[nodiscard]] bool endAt(std::uint64_t step) noexcept;
  void resume() noexcept;
  void stepBy(std::uint64_t steps) noexcept;  // run that many (more) steps, then pause
  void finish() noexcept;                     // orderly end here
  void abort() noexcept;
  /// Samples for any step but the open one are not counted; the return value says whether this one was.
  bool contactArrived(std::uint64_t step) noexcept;
  bool commandArrived(std::uint64_t step) noexcept;
  bool outgoingCommandArrived(std::uint64_t step) noexcept;
  void recorderAcknowledged(std::uint64_t step) noexcept;
  /// The open step is the first of a new holder: the outgoing one's command is needed as well.
  void needOutgoing(bool need) noexcept { needs_outgoing_ = need; }
  /// The open step is to be the last: the run goes back to its first step, or it does not after all.
  void holdForRewind(bool hold) noexcept { is_rewinding_ = hold; }
  /// Back to the first step, running or paused as now. Starts nothing that has not started or is over.
  void rewind() noexcept;
  /// A swap must be acknowledged before the open step ends.
  void awaitSwap(bool wait) noexcept { awaits_swap_ = wait; }

  // --- the decision
  [[nodiscard]] Hold hold() const noexcept;
  /// As hold(), without what the operator or the recorder wants: what a realtime loop has to do without.
  [[nodiscard]] Hold inputsHold() const noexcept;
  /// Ends the open step and opens the next one, whatever hold() says: lockstep callers ask first, realtime callers do
  /// not. At the end step the phase becomes kFinished. Does nothing unless running or single-stepping.
  void advance() noexcept;

  [[nodiscard]] SimPhase phase() const noexcept { return phase_; }
  [[nodiscard]] bool isOver() const noexcept { return phase_ == SimPhase::kFinished || phase_ == SimPhase::kAborted; }
  [[nodiscard]] std::uint64_t step() const noexcept { return step_; }
  [[nodiscard]] std::uint64_t firstStep() const noexcept { return config_.first_step; }
  [[nodiscard]] std::uint64_t endStep() const noexcept { return config_.end_step; }
  [[nodiscard]] bool hasCommand() const noexcept { return has_command_; }
  [[nodiscard]] bool hasContact() const noexcept { return has_contact_; }
  [[nodiscard]] bool hasOutgoingCommand() const noexcept { return has_outgoing_; }

 private:
  void openStep() noexcept;

  StepMasterConfig config_;
  SimPhase phase_ = SimPhase::kStarting;
  std::uint64_t step_ = 0;
  std::uint64_t pause_step_ = 0;  // asked for with pauseAt(); 0: none
  std::uint64_t step_until_ = 0;  // of a stepBy(); 0: none
  std::uint64_t acknowledged_ = 0;
  bool has_contact_ = false;
  bool has_command_ = false;
  bool has_outgoing_ = false;
  bool needs_outgoing_ = false;
  bool awaits_swap_ = false;
  bool is_rewinding_ = false;
};

}  // namespace baton
