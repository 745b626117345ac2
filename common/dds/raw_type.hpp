/// The one type support Baton registers: it moves serialized payloads in and out untouched. Typed endpoints serialise
/// before and after it, so that recorder, replayer, hashes and typed code all see the same bytes. Private to
/// common/dds.
#pragma once

#include <cstring>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <span>
#include <string>
#include <vector>

namespace baton::dds {

class RawType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  RawType(const std::string& type_name, std::uint32_t max_payload, bool keyed) {
    setName(type_name.c_str());
    m_typeSize = max_payload;
    m_isGetKeyDefined = keyed;
    // Advertising type objects makes Cyclone DDS refuse the match.
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  /// What write() is given.
  struct Outgoing {
    std::span<const std::byte> payload;
  };
  /// What take() fills.
  struct Incoming {
    std::vector<std::byte> payload;
  };

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    const auto& outgoing = *static_cast<const Outgoing*>(data);
    if (outgoing.payload.size() > payload->max_size) return false;
    std::memcpy(payload->data, outgoing.payload.data(), outgoing.payload.size());
    payload->length = static_cast<std::uint32_t>(outgoing.payload.size());
    payload->encapsulation =
        static_cast<std::uint16_t>(outgoing.payload.size() > 1 ? outgoing.payload[1] : std::byte{1});
    return true;
  }

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    auto& incoming = *static_cast<Incoming*>(data);
    const auto* begin = reinterpret_cast<const std::byte*>(payload->data);
    incoming.payload.assign(begin, begin + payload->length);
    return true;
  }

  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size = static_cast<std::uint32_t>(static_cast<const Outgoing*>(data)->payload.size());
    return [size] { return size; };
  }

  void* createData() override { return new Incoming; }
  void deleteData(void* data) override { delete static_cast<Incoming*>(data); }
  /// Baton's own topics have no keys; a foreign keyed topic carries its key hash in-line.
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace baton::dds
