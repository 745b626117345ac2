#include "ring.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace baton {
namespace {

constexpr std::size_t kOlderShare = 4;  // of the memory, for what has lasted longer than the ring

}  // namespace

Ring::Ring(std::uint64_t steps, std::size_t max_bytes)
    : steps_(steps),
      capacity_(max_bytes - max_bytes / kOlderShare),
      memory_(new std::byte[capacity_]),  // not make_unique, which would touch all of it
      end_(capacity_) {}

std::size_t Ring::sizeOf(const Sample& sample) {
  const std::size_t bytes = sizeof(Sample) + sample.payload.size();
  return (bytes + alignof(Sample) - 1) / alignof(Sample) * alignof(Sample);
}

Ring::Sample Ring::sampleAt(std::size_t offset) const {
  Sample sample;
  std::memcpy(static_cast<void*>(&sample), memory_.get() + offset, sizeof sample);
  sample.payload = {memory_.get() + offset + sizeof sample, sample.payload.size()};
  return sample;
}

bool Ring::push(const Sample& sample) {
  const std::size_t size = sizeOf(sample);
  if (size > capacity_) return false;
  while (count_ > 0 && sampleAt(first_).step + steps_ < sample.step) popOldest();
  const auto hasRoom = [&] {
    if (count_ == 0) return true;
    if (next_ > first_) return next_ + size <= capacity_ || size <= first_;
    return next_ + size <= first_;
  };
  while (!hasRoom()) popOldest();
  if (count_ == 0) {
    first_ = next_ = 0;
    end_ = capacity_;
  } else if (next_ > first_ && next_ + size > capacity_) {
    end_ = std::exchange(next_, 0);
  }
  std::memcpy(memory_.get() + next_, static_cast<const void*>(&sample), sizeof sample);
  std::ranges::copy(sample.payload, memory_.get() + next_ + sizeof sample);  // of none, memcpy would want an address
  next_ += size;
  ++count_;
  used_ += size;
  return true;
}

void Ring::popOldest() {
  const Sample sample = sampleAt(first_);
  if (sample.lasting != Lasting::kNo) keep(sample);
  const std::size_t size = sizeOf(sample);
  first_ += size;
  --count_;
  used_ -= size;
  if (first_ == end_ && count_ > 0) {
    first_ = 0;
    end_ = capacity_;
  }
}

void Ring::keep(const Sample& sample) {
  Kept kept{sample, {sample.payload.begin(), sample.payload.end()}};
  if (sample.lasting == Lasting::kLatest) {
    Kept& known = latest_[sample.stream];
    older_bytes_ += kept.bytes.size();
    older_bytes_ -= known.bytes.size();
    known = std::move(kept);
    return;
  }
  older_bytes_ += kept.bytes.size();
  older_.push_back(std::move(kept));
  const std::size_t most = capacity_ / (kOlderShare - 1);
  while (older_bytes_ > most && !older_.empty()) {
    older_bytes_ -= older_.front().bytes.size();
    older_.pop_front();
  }
}

void Ring::forEach(const std::function<void(const Sample&)>& callback) const {
  std::vector<const Kept*> older;
  for (const Kept& one : older_) older.push_back(&one);
  for (const auto& [stream, one] : latest_) older.push_back(&one);
  std::stable_sort(older.begin(), older.end(),
                   [](const Kept* a, const Kept* b) { return a->sample.log_time_ns < b->sample.log_time_ns; });
  for (const Kept* one : older) {
    Sample sample = one->sample;
    sample.payload = one->bytes;
    callback(sample);
  }
  std::size_t at = first_;
  for (std::size_t i = 0; i < count_; ++i) {
    const Sample sample = sampleAt(at);
    callback(sample);
    at += sizeOf(sample);
    if (at == end_) at = 0;
  }
}

std::optional<std::uint64_t> Ring::firstStep() const {
  return count_ == 0 ? std::nullopt : std::optional(sampleAt(first_).step);
}

void Ring::clear() {
  first_ = next_ = count_ = used_ = older_bytes_ = 0;
  end_ = capacity_;
  older_.clear();
  latest_.clear();
}

}  // namespace baton
