#include "sample_queue.hpp"

#include <algorithm>
#include <utility>

namespace baton {

bool SampleQueue::push(std::uint32_t topic, const dds::RawSample& sample) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    if (is_closed_) return true;  // too late to matter
    if (pending_.payloads.size() + sample.payload.size() > max_bytes_) return false;
    last_log_time_ns_ = std::max(last_log_time_ns_, std::int64_t{std::chrono::nanoseconds(now).count()});
    pending_.entries.push_back({.topic = topic,
                                .sequence = sample.sequence,
                                .log_time_ns = last_log_time_ns_,
                                .source_timestamp_ns = sample.source_timestamp_ns,
                                .writer = sample.writer,
                                .offset = pending_.payloads.size(),
                                .size = sample.payload.size()});
    pending_.payloads.insert(pending_.payloads.end(), sample.payload.begin(), sample.payload.end());
    wake = pending_.entries.size() == wake_entries_;
  }
  if (wake) wake_.notify_one();
  return true;
}

bool SampleQueue::take(Batch& batch, std::chrono::milliseconds timeout) {
  batch.entries.clear();
  batch.payloads.clear();
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, timeout, [this] { return is_closed_ || pending_.entries.size() >= wake_entries_; });
  std::swap(batch, pending_);
  return !is_closed_ || !batch.entries.empty();
}

void SampleQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  wake_.notify_one();
}

}  // namespace baton
