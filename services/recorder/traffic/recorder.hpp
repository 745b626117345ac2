/// Records the traffic of a DDS domain, without a run: no service, no barrier, and no process waits for it.
///
/// Threads: DDS's receive thread queues samples; the session's writes them; the caller's makes readers and takes
/// signals.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <string>
#include <vector>

#include "discovery.hpp"
#include "sample_queue.hpp"
#include "traffic/session.hpp"

namespace baton {

class TrafficRecorder {
 public:
  /// Joins the domain, then takes the place of the file, `options.out`: what is there stays when anything else of the
  /// options is wrong. Throws UsageError and UnavailableError.
  explicit TrafficRecorder(TrafficOptions options);
  TrafficRecorder(const TrafficRecorder&) = delete;
  TrafficRecorder& operator=(const TrafficRecorder&) = delete;

  /// Until one of endingSignals(), a limit or a failure. Every further signal is answered by a line: the file is being
  /// finished.
  TrafficResult run();

 private:
  [[nodiscard]] dds::ParticipantOptions participantOptions() const;
  [[nodiscard]] ReadingRules rules();
  void awaitSignal();
  void awaitDuration();

  const TrafficOptions options_;
  boost::asio::io_context executor_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{executor_.get_executor()};
  boost::asio::signal_set signals_{executor_};
  boost::asio::steady_timer duration_{executor_};
  bool is_ending_ = false;
  dds::Participant participant_;
  SampleQueue queue_;
  TopicReaders topics_;
  TrafficSession session_;
};

/// The whole of `baton record traffic`, but for the command line's own name.
[[nodiscard]] ExitCode recordTraffic(int argc, const char* const* argv);

}  // namespace baton
