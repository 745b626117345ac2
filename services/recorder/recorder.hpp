/// Records every topic of the cell: finds writers as they appear, takes their samples as raw bytes, and writes one MCAP
/// file with a completeness certificate. Needs no type but the manifests' and the services' status.
///
/// Two threads beside the executor: DDS's receive thread queues samples; `file_thread_` writes them, acknowledges steps
/// (the plant's credit) and closes the file. Only the latter touches the file, the ledger and the status topic.
/// The recorder's own topics are not recorded: writing them would change them.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "dds/endpoint.hpp"
#include "mcap/writer.hpp"
#include "runtime/ledger.hpp"
#include "runtime/service.hpp"
#include "sample_queue.hpp"

namespace baton {

class Recorder {
 public:
  explicit Recorder(Service& service);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Records until the run has ended and everything is here, or until asked to stop. Returns kOk for a complete
  /// recording, kFailed for one that is not.
  ExitCode run();

 private:
  struct Topic {
    dds::EndpointOptions options;
    std::unique_ptr<dds::RawReader> reader;
  };

  // executor
  void writerFound(const dds::DiscoveredWriter& writer);
  [[nodiscard]] bool isFor(std::uint32_t topic, const dds::Guid& writer);
  void requireServices();
  // file thread
  void writeFile();
  void writeBatch(const SampleQueue::Batch& batch);
  void acknowledge(bool is_idle);
  void onRewind(const msg::Rewind& rewind);
  void answerRewind();
  mcap::ChannelId channelOf(const SampleQueue::Entry& entry, const Topic& topic);
  void finishFile();
  void publishStatus(msg::RecorderState state, const std::string& text);
  [[nodiscard]] mcap::StringMap channelMetadata(const dds::Guid& writer) const;

  Service& service_;
  mcap::Writer file_;
  SampleQueue queue_;
  Ledger ledger_;
  dds::Writer<msg::RecorderStatus>& status_out_;
  dds::Writer<msg::RewindAck>& rewind_ack_out_;
  std::optional<msg::Rewind> owed_;  // an answer to this
  std::uint32_t take_ = 0;

  // Topics and writers, found by discovery: added on the executor, read by the file thread.
  mutable std::mutex topics_mutex_;
  std::vector<std::unique_ptr<Topic>> topics_;
  struct WriterFacts {
    std::string service;  // noted when it is found: who asks something leaves soon
    std::string qos;
  };
  std::map<dds::Guid, WriterFacts> writer_facts_;
  // A reader hears writers of a stronger QoS as well: of two on a topic, each takes its own.
  std::atomic<bool> has_rivals_{false};
  std::mutex routes_mutex_;
  std::map<dds::Guid, std::uint32_t> routes_;

  // file thread
  std::map<Ledger::Key, mcap::ChannelId> channels_;
  std::map<std::string, std::uint64_t> loop_steps_;  // latest step here, by topic of the loop that has to be complete
  std::uint64_t progress_ = 0;                       // samples of which every one matters
  std::uint64_t acknowledged_ = 0;
  std::uint64_t published_ = 0;

  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> has_run_ended_{false};
  ExitCode result_ = ExitCode::kFailed;
  std::thread file_thread_;
};

}  // namespace baton
