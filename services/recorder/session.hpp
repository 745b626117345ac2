/// The thread that writes: takes what has been received, keeps it as the operator and the scenario want, tells the
/// plant how far it may run on, and answers requests. Only this thread touches files, accounts and the recorder's
/// topics.
///
/// Whatever becomes of the recording, what comes is taken and acknowledged: the run goes on.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "control.hpp"
#include "credit.hpp"
#include "discovery.hpp"
#include "recording.hpp"
#include "ring.hpp"
#include "room.hpp"
#include "run_notes.hpp"
#include "runtime/service.hpp"
#include "sample_queue.hpp"

namespace baton {

class RecordingSession {
 public:
  /// Opens the file, when the recording begins at once. Throws UnavailableError.
  RecordingSession(Service& service, SampleQueue& queue, const TopicReaders& topics);

  /// Until the queue is closed, or the run has ended and everything is here. Returns kOk when every recording that was
  /// made is complete.
  ExitCode run();
  /// From any thread.
  void ask(const msg::RecordRequest& request);
  void runHasEnded() { has_run_ended_ = true; }

 private:
  // what comes
  void takeBatch(const SampleQueue::Batch& batch);
  [[nodiscard]] Stream& streamOf(std::uint32_t topic, const dds::Guid& writer);
  void keep(const Stream& stream, const SampleQueue::Entry& entry, std::span<const std::byte> payload,
            std::uint64_t lost_before);
  void write(const Stream& stream, const SampleQueue::Entry& entry, std::span<const std::byte> payload,
             std::uint64_t lost_before);
  void learn(const Stream& stream, std::span<const std::byte> payload);
  // what is asked
  [[nodiscard]] std::vector<msg::RecordRequest> takeRequests();
  void reply(const msg::RecordRequest& request);
  [[nodiscard]] msg::RecordReply answer(const msg::RecordRequest& request);
  [[nodiscard]] std::string objectionTo(const msg::RecordRequest& request) const;
  void start(const std::string& path);
  std::string pathOf(const msg::RecordRequest& request) const;
  // what is done now and then
  void acknowledge(bool is_idle);
  void tend();
  [[nodiscard]] bool isDone();
  void publishStatus();
  void addLosses(msg::RecorderStatus& status) const;
  // session_files.cpp: files that grow, and how they end
  void makeRoom();
  std::string finish(const Ending& ending);
  std::string writeRing(const std::string& path, const Ending& ending);
  std::string close(Recording& recording, std::uint64_t begun_at, const Ending& ending, const std::vector<Hole>& holes);
  void closeAll();
  void fail(const std::string& what);

  Service& service_;
  const RecordingConfig& config_;
  SampleQueue& queue_;
  const TopicReaders& topics_;
  dds::Writer<msg::RecorderStatus>& status_out_;
  dds::Writer<msg::RewindAck>& rewind_ack_out_;
  dds::Writer<msg::RecordReply>& reply_out_;

  const Origin origin_;
  RecordingControl control_;
  StepCredit credit_;
  Ledger ledger_;
  RunNotes notes_;
  Holes holes_;
  std::map<std::pair<std::uint32_t, dds::Guid>, Stream> streams_;
  Latched latched_{kMostLatchedBytes, kMostForeignLatchedBytes};
  bool told_given_up_ = false;
  std::unique_ptr<Recording> recording_;
  std::unique_ptr<Ring> ring_;
  std::string path_;            // of the latest recording
  std::uint64_t begun_at_ = 0;  // steps of the run, when it began
  std::string text_;            // what the status says
  std::uint64_t progress_ = 0;  // samples of which every one matters
  std::chrono::steady_clock::time_point tended_{};
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point moved_{};  // after the run's end
  std::optional<std::uint64_t> progress_at_end_;
  Room room_;
  std::uint64_t finished_messages_ = 0;  // of the latest recording, when it is finished
  std::uint64_t finished_bytes_ = 0;
  std::string incomplete_;  // the first of the recordings made that is

  std::mutex requests_mutex_;
  std::vector<msg::RecordRequest> requests_;
  std::atomic<bool> has_run_ended_{false};
};

}  // namespace baton
