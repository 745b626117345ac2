#include "control.hpp"

namespace baton {

std::string RecordingControl::objection(msg::RecordAction action) const {
  if (state_ == msg::RECORDER_CLOSED) return "the run is over";
  const bool is_begin_or_end = action == msg::RECORD_START || action == msg::RECORD_STOP;
  if (is_ring_ && is_begin_or_end) {
    return "the scenario keeps a ring (recording.ring_s): `record snapshot` writes what it holds";
  }
  switch (action) {
    case msg::RECORD_START:
      if (state_ == msg::RECORDER_PAUSED) return "the recording is paused: `record resume` goes on with it";
      return isOpen() ? "a recording is under way: `record stop` ends it" : "";
    case msg::RECORD_STOP: return isOpen() ? "" : "nothing is being recorded: `record start` begins";
    case msg::RECORD_PAUSE:
      if (state_ == msg::RECORDER_PAUSED) return "it is paused already";
      return keeps() ? "" : "nothing is being recorded: `record start` begins";
    case msg::RECORD_RESUME:
      if (keeps()) return "it is not paused";
      return isOpen() ? "" : "nothing is being recorded: `record start` begins";
    case msg::RECORD_SNAPSHOT: return is_ring_ ? "" : "the scenario keeps no ring: give recording: {ring_s: SECONDS}";
  }
  return "expected start, stop, pause, resume or snapshot";
}

void RecordingControl::done(msg::RecordAction action) {
  switch (action) {
    case msg::RECORD_START:
    case msg::RECORD_RESUME: state_ = msg::RECORDER_RECORDING; break;
    case msg::RECORD_STOP: state_ = msg::RECORDER_STOPPED; break;
    case msg::RECORD_PAUSE: state_ = msg::RECORDER_PAUSED; break;
    case msg::RECORD_SNAPSHOT: break;
  }
}

}  // namespace baton
