/// The one type support Baton registers: it moves serialized payloads in and out untouched. Typed endpoints serialise
/// before and after it, so that recorder, replayer, hashes and typed code all see the same bytes. It advertises no type
/// objects, which make Cyclone DDS refuse the match. Private to common/dds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "dds/fastdds.hpp"

namespace baton::dds {

/// Baton's own topics have no keys; a foreign keyed topic may carry the hash of its key in-line.
class RawType final : public fastdds::BytesType {
 public:
  using BytesType::BytesType;

  struct Data {
    bool is_received = false;
  };
  /// What write() is given.
  struct Outgoing : Data {
    explicit Outgoing(std::span<const std::byte> bytes) : payload(bytes) {}
    std::span<const std::byte> payload;
  };
  /// What take() fills.
  struct Incoming : Data {
    Incoming() : Data{.is_received = true} {}
    std::vector<std::byte> payload;
  };

  [[nodiscard]] bool put(const void* data, fastdds::rtps::SerializedPayload_t& payload) const override {
    const auto& outgoing = *static_cast<const Outgoing*>(data);
    if (outgoing.payload.size() > payload.max_size) return false;
    std::memcpy(payload.data, outgoing.payload.data(), outgoing.payload.size());
    payload.length = static_cast<std::uint32_t>(outgoing.payload.size());
    payload.encapsulation =
        static_cast<std::uint16_t>(outgoing.payload.size() > 1 ? outgoing.payload[1] : std::byte{1});
    return true;
  }

  [[nodiscard]] bool take(const fastdds::rtps::SerializedPayload_t& payload, void* data) const override {
    auto& incoming = *static_cast<Incoming*>(data);
    const auto* begin = reinterpret_cast<const std::byte*>(payload.data);
    incoming.payload.assign(begin, begin + payload.length);
    return true;
  }

  [[nodiscard]] std::uint32_t sizeOf(const void* data) const override {
    return static_cast<std::uint32_t>(static_cast<const Outgoing*>(data)->payload.size());
  }
  [[nodiscard]] void* make() const override { return new Incoming; }
  void destroy(void* data) const override { delete static_cast<Incoming*>(data); }
  [[nodiscard]] bool isReceived(const void* data) const override { return static_cast<const Data*>(data)->is_received; }
};

}  // namespace baton::dds
