/// Real DDS between participants of one test: a domain of its own, loopback UDP as between the processes of a run, and
/// waiting for what happens. The deadline is generous and only ever fails a test.
#pragma once

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "dds/participant.hpp"
#include "dds/types.hpp"
#include "support/own_domain.hpp"

namespace baton::test {

inline std::string testPartition(const std::string& name) { return "unit-" + std::to_string(getpid()) + "/" + name; }

inline dds::ParticipantOptions memberOptions(const std::string& service, const std::string& partition) {
  return {.domain = ownDomain(),
          .partition = testPartition(partition),
          .cell = "unit",
          .run = std::to_string(getpid()),
          .service = service};
}

/// Something has happened; look whether it is what you wait for.
class Signal {
 public:
  void notify() {
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
  }
  /// Waits until `condition` holds, asking again after each notify(). Returns false when the deadline has passed.
  template <class Condition>
  [[nodiscard]] bool waitUntil(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(30), condition);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

struct Received {
  std::vector<std::byte> payload;
  std::uint64_t sequence;
  std::int64_t source_timestamp_ns;
  std::int64_t reception_timestamp_ns;
  dds::Guid writer;
};

/// What a reader got, in order.
class Inbox {
 public:
  explicit Inbox(Signal& signal) : signal_(signal) {}

  void put(const dds::RawSample& sample) {
    {
      const std::lock_guard lock(mutex_);
      samples_.push_back({{sample.payload.begin(), sample.payload.end()},
                          sample.sequence,
                          sample.source_timestamp_ns,
                          sample.reception_timestamp_ns,
                          sample.writer});
    }
    signal_.notify();
  }
  [[nodiscard]] std::vector<Received> samples() const {
    const std::lock_guard lock(mutex_);
    return samples_;
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return samples_.size();
  }

 private:
  Signal& signal_;
  mutable std::mutex mutex_;
  std::vector<Received> samples_;
};

}  // namespace baton::test
