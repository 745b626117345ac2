/// Readers and writers of messages: a raw endpoint plus the codec.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "dds/codec.hpp"
#include "dds/endpoint.hpp"
#include "dds/hash.hpp"
#include "dds/topics.hpp"

namespace baton::dds {

template <class T>
[[nodiscard]] EndpointOptions endpointOptions(const Topic<T>& topic) {
  return {.topic = topic.name,
          .type = topic.type,
          .profile = topic.profile,
          .max_payload = static_cast<std::uint32_t>(maxPayload<T>())};
}

/// Not safe to call from several threads at once: the service's lock guards it.
template <class T>
class Writer {
 public:
  Writer(Participant& participant, const Topic<T>& topic, MatchCallback on_match = {})
      : topic_(topic.name), buffer_(maxPayload<T>()), raw_(participant, endpointOptions(topic), std::move(on_match)) {}

  /// Never blocks, and allocates nothing of its own. Returns false when DDS refuses the sample, which is counted.
  bool write(const T& message) noexcept {
    payload_ = encode(message, std::span(buffer_));
    if (payload_.empty() || !raw_.write(payload_)) {
      ++refused_;
      return false;
    }
    stream_hash_ = chainHash(stream_hash_, payload_);
    return true;
  }

  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  /// What write() sent last.
  [[nodiscard]] std::span<const std::byte> payload() const { return payload_; }
  /// Of all payloads in order.
  [[nodiscard]] std::uint64_t streamHash() const { return stream_hash_; }
  [[nodiscard]] const std::string& topic() const { return topic_; }
  [[nodiscard]] RawWriter& raw() { return raw_; }
  [[nodiscard]] const RawWriter& raw() const { return raw_; }

 private:
  std::string topic_;
  std::vector<std::byte> buffer_;
  std::span<const std::byte> payload_;
  std::uint64_t stream_hash_ = 0;
  std::uint64_t refused_ = 0;
  RawWriter raw_;
};

/// Calls back on a DDS thread with the message, decoded into one reused object, and its sample.
template <class T>
class Reader {
 public:
  using Callback = std::function<void(const T&, const RawSample&)>;

  Reader(Participant& participant, const Topic<T>& topic, Callback callback, MatchCallback on_match = {},
         WriterFilter filter = {})
      : callback_(std::move(callback)),
        raw_(
            participant, endpointOptions(topic),
            [this](const RawSample& sample) {
              if (decode(sample.payload, message_)) {
                callback_(message_, sample);
              } else {
                ++rejected_;
              }
            },
            std::move(on_match), std::move(filter)) {}

  /// Samples that were not a message of this type.
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }
  [[nodiscard]] const RawReader& raw() const { return raw_; }

 private:
  Callback callback_;
  T message_;
  std::atomic<std::uint64_t> rejected_{0};
  RawReader raw_;
};

}  // namespace baton::dds
