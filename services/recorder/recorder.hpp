/// Records every topic of the cell: finds writers as they appear, takes their samples as raw bytes, and writes MCAP
/// files with a completeness certificate. Needs no type but those that tell how the run stands.
///
/// Two threads beside the executor: DDS's receive thread queues samples; the session's takes them from there, writes
/// them, acknowledges steps (the plant's credit) and does what operators ask.
#pragma once

#include <optional>
#include <thread>

#include "discovery.hpp"
#include "sample_queue.hpp"
#include "session.hpp"

namespace baton {

class Recorder {
 public:
  explicit Recorder(Service& service);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Records until the run has ended and everything is here, or until asked to stop. Returns kOk when every recording
  /// made is complete, kFailed when one is not.
  ExitCode run();

 private:
  Service& service_;
  SampleQueue queue_;
  TopicReaders topics_;
  RecordingSession session_;
  ExitCode result_ = ExitCode::kFailed;
  std::thread thread_;
};

}  // namespace baton
