#include "messages/state_names.hpp"

namespace baton {

const char* toString(msg::SimState state) {
  switch (state) {
    case msg::SIM_STATE_STARTING: return "starting";
    case msg::SIM_STATE_RUNNING: return "running";
    case msg::SIM_STATE_PAUSED: return "paused";
    case msg::SIM_STATE_FINISHED: return "finished";
    case msg::SIM_STATE_ABORTED: return "aborted";
  }
  return "?";
}

const char* toString(msg::ControllerState state) {
  switch (state) {
    case msg::CONTROLLER_STARTING: return "starting";
    case msg::CONTROLLER_COLD: return "cold";
    case msg::CONTROLLER_STANDBY: return "standby";
    case msg::CONTROLLER_ACTIVE: return "active";
    case msg::CONTROLLER_FAILED: return "failed";
  }
  return "?";
}

const char* toString(msg::ServiceState state) {
  switch (state) {
    case msg::SERVICE_STARTING: return "starting";
    case msg::SERVICE_READY: return "ready";
    case msg::SERVICE_FAILED: return "failed";
  }
  return "?";
}

const char* toString(msg::RecorderState state) {
  switch (state) {
    case msg::RECORDER_RECORDING: return "recording";
    case msg::RECORDER_PAUSED: return "paused";
    case msg::RECORDER_STOPPED: return "stopped";
    case msg::RECORDER_CLOSED: return "closed";
    case msg::RECORDER_FAILED: return "failed";
  }
  return "?";
}

const char* toString(msg::ReplayState state) {
  switch (state) {
    case msg::REPLAY_WAITING: return "waiting";
    case msg::REPLAY_PLAYING: return "playing";
    case msg::REPLAY_PAUSED: return "paused";
    case msg::REPLAY_FINISHED: return "finished";
  }
  return "?";
}

}  // namespace baton
