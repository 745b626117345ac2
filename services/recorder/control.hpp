/// What may be asked of a recorder when: a plain state machine. Doing it is somebody else's part.
#pragma once

#include <string>

#include "msg/record.h"

namespace baton {

class RecordingControl {
 public:
  /// @param is_ring  the latest is kept in memory: it can be paused and written, and there is nothing to start or stop.
  RecordingControl(bool is_ring, bool starts_stopped)
      : is_ring_(is_ring), state_(starts_stopped ? msg::RECORDER_STOPPED : msg::RECORDER_RECORDING) {}

  /// Why this cannot be done now; empty when it can.
  [[nodiscard]] std::string objection(msg::RecordAction action) const;
  /// It has been done; there was no objection.
  void done(msg::RecordAction action);
  /// The recording has come to an end of its own: by its policy, or because it could not be written.
  void ended() { state_ = msg::RECORDER_STOPPED; }
  void failed() { state_ = msg::RECORDER_FAILED; }
  /// The run is over, and every file closed.
  void closed() { state_ = msg::RECORDER_CLOSED; }

  [[nodiscard]] bool isRing() const { return is_ring_; }
  [[nodiscard]] msg::RecorderState state() const { return state_; }
  /// Whether what comes is kept.
  [[nodiscard]] bool keeps() const { return state_ == msg::RECORDER_RECORDING; }
  /// Whether there is a recording that goes on, if only later.
  [[nodiscard]] bool isOpen() const { return state_ == msg::RECORDER_RECORDING || state_ == msg::RECORDER_PAUSED; }

 private:
  bool is_ring_;
  msg::RecorderState state_;
};

}  // namespace baton
