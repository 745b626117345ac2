#include "sample_queue.hpp"

#include <algorithm>
#include <utility>

namespace baton {

constexpr std::size_t kFewEntries = 1024;

bool SampleQueue::push(std::uint32_t topic, const dds::RawSample& sample, Share share) {
  const std::int64_t now_ns = clock_.now();
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    if (is_closed_) return true;  // too late to matter
    const bool is_half = share == Share::kHalf;
    bool& is_full = is_half ? is_half_full_ : is_full_;
    const std::size_t most = is_half ? max_bytes_ / 2 : max_bytes_;
    // An entry takes room as well: of samples with few bytes or none there may be so many.
    is_full = is_full || pending_.payloads.size() + sample.payload.size() > most ||
              pending_.entries.size() >= std::max(most / sizeof(Entry), kFewEntries);
    if (is_full || is_full_) {
      drop(topic, sample);
      return false;
    }
    last_log_time_ns_ = std::max(last_log_time_ns_, now_ns);
    // A writer may send no time with its samples; MCAP wants the log time there then.
    const bool has_time = sample.source_timestamp_ns > 0;
    pending_.entries.push_back({.topic = topic,
                                .sequence = sample.sequence,
                                .log_time_ns = last_log_time_ns_,
                                .source_timestamp_ns = has_time ? sample.source_timestamp_ns : last_log_time_ns_,
                                .writer = sample.writer,
                                .offset = pending_.payloads.size(),
                                .size = sample.payload.size(),
                                .has_data = sample.has_data});
    pending_.payloads.insert(pending_.payloads.end(), sample.payload.begin(), sample.payload.end());
    wake = pending_.entries.size() == wake_entries_;
  }
  if (wake) wake_.notify_one();
  return true;
}

void SampleQueue::drop(std::uint32_t topic, const dds::RawSample& sample) {
  for (Drop& one : pending_.drops) {
    if (one.topic != topic || one.writer != sample.writer) continue;
    one.last_sequence = sample.sequence;
    return;
  }
  pending_.drops.push_back({topic, sample.writer, sample.sequence, sample.sequence});
}

SampleQueue::Depth SampleQueue::depth() {
  const std::lock_guard lock(mutex_);
  return {pending_.entries.size(), pending_.payloads.size()};
}

bool SampleQueue::take(Batch& batch, std::chrono::milliseconds timeout) {
  batch.entries.clear();
  batch.payloads.clear();
  batch.drops.clear();
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, timeout, [this] { return is_closed_ || pending_.entries.size() >= wake_entries_; });
  std::swap(batch, pending_);
  is_full_ = is_half_full_ = false;
  return !is_closed_ || !batch.entries.empty() || !batch.drops.empty();
}

void SampleQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  wake_.notify_one();
}

}  // namespace baton
