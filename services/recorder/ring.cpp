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
      end_(capacity_),
      older_(max_bytes / kOlderShare) {}

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
  left_out_ += sample.is_left_out ? 1 : 0;
  used_ += size;
  return true;
}

void Ring::popOldest() {
  const Sample sample = sampleAt(first_);
  older_.keep(sample.stream, "", sample.latched, sample, sample.payload, sample.facts);
  const std::size_t size = sizeOf(sample);
  first_ += size;
  --count_;
  left_out_ -= sample.is_left_out ? 1 : 0;
  used_ -= size;
  if (first_ == end_ && count_ > 0) {
    first_ = 0;
    end_ = capacity_;
  }
}

void Ring::forEach(const std::function<void(const Sample&)>& callback) const {
  std::size_t at = first_;
  for (std::size_t i = 0; i < count_; ++i) {
    const Sample sample = sampleAt(at);
    if (!sample.is_left_out) callback(sample);
    at += sizeOf(sample);
    if (at == end_) at = 0;
  }
}

std::optional<std::uint64_t> Ring::firstStep() const {
  return count_ == 0 ? std::nullopt : std::optional(sampleAt(first_).step);
}

void Ring::clear() {
  first_ = next_ = count_ = left_out_ = used_ = 0;
  end_ = capacity_;
  older_.clear();
}

}  // namespace baton
