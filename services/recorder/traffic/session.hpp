/// The thread that writes a recording of traffic: takes what has been received, books it by writer, and ends the file
/// in order, with what was lost.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "discovery.hpp"
#include "recording.hpp"
#include "room.hpp"
#include "runtime/progress_line.hpp"
#include "sample_queue.hpp"
#include "traffic/options.hpp"
#include "traffic/result.hpp"

namespace baton {

class TrafficSession {
 public:
  /// Creates the file. The other arguments outlive it. Throws UnavailableError when the file is there or cannot be
  /// created.
  TrafficSession(const TrafficOptions& options, const std::filesystem::path& file, SampleQueue& queue,
                 const TopicReaders& topics);

  /// Until end(), a limit or a failure.
  TrafficResult run();
  /// What was received so far is still written; any thread, the first reason counts.
  void end(TrafficEnd how, const std::string& reason);

 private:
  void takeBatch(const SampleQueue::Batch& batch);
  [[nodiscard]] Stream& streamOf(std::uint32_t topic, const dds::Guid& writer);
  void keep(const Stream& stream, const SampleQueue::Entry& entry, std::span<const std::byte> payload,
            std::uint64_t lost_before);
  void tend();
  void showProgress();
  [[nodiscard]] bool isOver();
  [[nodiscard]] std::uint64_t elapsedMilliseconds() const;
  void fail(const std::string& what);
  void finish();
  void noteWhatCannotBeRecorded(const Recording& recording);
  void count(const Recording& recording);

  const TrafficOptions& options_;
  SampleQueue& queue_;
  const TopicReaders& topics_;
  const Origin origin_;
  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  Ledger ledger_{{}};
  std::map<std::pair<std::uint32_t, dds::Guid>, Stream> streams_;
  Latched latched_{kMostLatchedBytes};  // for the parts to come
  Room room_;
  std::unique_ptr<Recording> recording_;
  TrafficResult result_;
  std::chrono::steady_clock::time_point flushed_ = begun_;
  std::chrono::steady_clock::time_point shown_ = begun_;
  ProgressLine line_;

  std::mutex end_mutex_;
  std::optional<std::pair<TrafficEnd, std::string>> end_;
};

}  // namespace baton
