#include "time/step_master.hpp"

#include <algorithm>
#include <limits>

namespace baton {

const char* toString(Hold hold) noexcept {
  switch (hold) {
    case Hold::kNone: return "nothing";
    case Hold::kNotStarted: return "the other services to be ready";
    case Hold::kEnded: return "nothing, the run is over";
    case Hold::kPaused: return "sim resume";
    case Hold::kContact: return "the environment";
    case Hold::kCommand: return "the controller that holds the baton";
    case Hold::kHandover: return "the outgoing controller's last command";
    case Hold::kSwap: return "the controllers to acknowledge a swap";
    case Hold::kRecorder: return "the recorder";
    case Hold::kRewind: return "all services to forget the run";
  }
  return "?";
}

void StepMaster::openStep() noexcept {
  has_contact_ = false;
  has_command_ = false;
  has_outgoing_ = false;
  needs_outgoing_ = false;
}

void StepMaster::start() noexcept {
  if (phase_ == SimPhase::kStarting) phase_ = SimPhase::kRunning;
}

void StepMaster::pause() noexcept {
  if (phase_ == SimPhase::kRunning) phase_ = SimPhase::kPaused;
  step_until_ = 0;
}

bool StepMaster::pauseAt(std::uint64_t step) noexcept {
  if (isOver() || step <= step_ || (config_.end_step > 0 && step >= config_.end_step)) return false;
  pause_step_ = step;
  return true;
}

bool StepMaster::endAt(std::uint64_t step) noexcept {
  if (isOver() || step <= step_ || (config_.end_step > 0 && step > config_.end_step)) return false;
  config_.end_step = step;
  return true;
}

void StepMaster::resume() noexcept {
  if (phase_ == SimPhase::kPaused) phase_ = SimPhase::kRunning;
  step_until_ = 0;
}

void StepMaster::stepBy(std::uint64_t steps) noexcept {
  if (isOver() || phase_ == SimPhase::kStarting || steps == 0) return;
  // Steps asked for while others are still being run come on top of those.
  const bool is_stepping = phase_ == SimPhase::kRunning && step_until_ > step_;
  const std::uint64_t from = is_stepping ? step_until_ : step_;
  step_until_ = from + std::min(steps, std::numeric_limits<std::uint64_t>::max() - from);
  phase_ = SimPhase::kRunning;
}

void StepMaster::finish() noexcept {
  if (!isOver()) phase_ = SimPhase::kFinished;
}

void StepMaster::abort() noexcept {
  if (!isOver()) phase_ = SimPhase::kAborted;
}

void StepMaster::rewind() noexcept {
  is_rewinding_ = false;
  if (isOver() || phase_ == SimPhase::kStarting) return;
  step_ = acknowledged_ = config_.first_step;
  pause_step_ = step_until_ = 0;
  awaits_swap_ = false;
  openStep();
}

bool StepMaster::contactArrived(std::uint64_t step) noexcept {
  if (step != step_) return false;
  return has_contact_ = true;
}

bool StepMaster::commandArrived(std::uint64_t step) noexcept {
  if (step != step_) return false;
  return has_command_ = true;
}

bool StepMaster::outgoingCommandArrived(std::uint64_t step) noexcept {
  if (step != step_) return false;
  return has_outgoing_ = true;
}

void StepMaster::recorderAcknowledged(std::uint64_t step) noexcept { acknowledged_ = std::max(acknowledged_, step); }

Hold StepMaster::inputsHold() const noexcept {
  if (config_.needs_contact && !has_contact_) return Hold::kContact;
  if (!has_command_) return Hold::kCommand;
  if (needs_outgoing_ && !has_outgoing_) return Hold::kHandover;
  return Hold::kNone;
}

Hold StepMaster::hold() const noexcept {
  switch (phase_) {
    case SimPhase::kStarting: return Hold::kNotStarted;
    case SimPhase::kFinished:
    case SimPhase::kAborted: return Hold::kEnded;
    case SimPhase::kPaused: return is_rewinding_ ? Hold::kRewind : Hold::kPaused;
    case SimPhase::kRunning: break;
  }
  if (const Hold inputs = inputsHold(); inputs != Hold::kNone) return inputs;
  if (is_rewinding_) return Hold::kRewind;
  if (awaits_swap_) return Hold::kSwap;
  const bool is_ahead = step_ > acknowledged_ && step_ - acknowledged_ >= config_.credit;
  if (config_.credit > 0 && is_ahead) return Hold::kRecorder;
  return Hold::kNone;
}

void StepMaster::advance() noexcept {
  if (phase_ != SimPhase::kRunning) return;
  ++step_;
  openStep();
  if (config_.end_step > 0 && step_ >= config_.end_step) {
    phase_ = SimPhase::kFinished;
  } else if (step_ == pause_step_ || step_ == step_until_) {
    phase_ = SimPhase::kPaused;
    if (step_ == pause_step_) pause_step_ = 0;
    step_until_ = 0;
  }
}

}  // namespace baton
