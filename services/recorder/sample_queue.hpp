/// Samples on their way from DDS's receive thread to the thread that writes the file. Bounded; nothing is allocated
/// once the two halves have grown to what a batch needs.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "dds/types.hpp"
#include "dds/wall_clock.hpp"

namespace baton {

class SampleQueue {
 public:
  struct Entry {
    std::uint32_t topic = 0;  // the recorder's index
    std::uint64_t sequence = 0;
    std::int64_t log_time_ns = 0;
    std::int64_t source_timestamp_ns = 0;
    dds::Guid writer;
    std::size_t offset = 0;  // of the payload in Batch::payloads
    std::size_t size = 0;
    bool has_data = true;  // as dds::RawSample has it
  };
  /// Samples of one writer that found no room, after all the entries of their batch.
  struct Drop {
    std::uint32_t topic = 0;
    dds::Guid writer;
    std::uint64_t first_sequence = 0;
    std::uint64_t last_sequence = 0;
  };
  struct Batch {
    std::vector<Entry> entries;
    std::vector<std::byte> payloads;
    std::vector<Drop> drops;
    [[nodiscard]] std::span<const std::byte> payload(const Entry& entry) const {
      return std::span(payloads).subspan(entry.offset, entry.size);
    }
  };

  /// @param max_bytes payload bytes held before samples are dropped.  @param wake_entries how many entries wake the
  /// writer before its time.  @param clock  of the log times.
  SampleQueue(std::size_t max_bytes, std::size_t wake_entries, const dds::WallClock& clock = {})
      : max_bytes_(max_bytes), wake_entries_(wake_entries), clock_(clock) {}

  /// How much of the queue a sample may find room in: what has half of it cannot keep the rest from being written.
  enum class Share : std::uint8_t { kWhole, kHalf };

  /// Returns false when its share is full and the sample is dropped, and with it all of that share that follow until
  /// the next take(): what is missing of a writer then lies in one piece. Once closed, it takes no notice of samples.
  /// The log time is stamped here, at one place, and never decreases.
  bool push(std::uint32_t topic, const dds::RawSample& sample, Share share = Share::kWhole);

  /// Waits for samples, at most `timeout`, and moves them to `batch` (emptied first). Returns false when the queue is
  /// closed and empty.
  bool take(Batch& batch, std::chrono::milliseconds timeout);

  void close();

  /// Samples and payload bytes that wait.
  struct Depth {
    std::size_t samples = 0;
    std::size_t bytes = 0;
  };
  [[nodiscard]] Depth depth();

 private:
  void drop(std::uint32_t topic, const dds::RawSample& sample);

  std::size_t max_bytes_;
  std::size_t wake_entries_;
  const dds::WallClock clock_;
  std::mutex mutex_;
  std::condition_variable wake_;
  Batch pending_;
  bool is_full_ = false;
  bool is_half_full_ = false;
  std::int64_t last_log_time_ns_ = 0;
  bool is_closed_ = false;
};

}  // namespace baton
