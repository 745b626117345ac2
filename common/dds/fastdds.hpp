/// Fast DDS 2.9 (Debian 12) and Fast DDS 3 (Debian 13) under one set of names, those of the later one where they
/// differ. This header is the only place that knows which of them it is. For common/dds, its tests and the yardstick of
/// tests/bench/loop.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#if __has_include(<fastdds/LibrarySettings.hpp>)
#define BATON_FASTDDS 3
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/rtps/common/WriteParams.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.hpp>
#else
#define BATON_FASTDDS 2
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace baton::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace transport = eprosima::fastdds::rtps;
#if BATON_FASTDDS == 3
namespace rtps = eprosima::fastdds::rtps;
namespace core = eprosima::fastdds::dds;
#else
namespace rtps = eprosima::fastrtps::rtps;
namespace core = eprosima::fastrtps;
#endif

#if BATON_FASTDDS == 3
inline constexpr const char* kVersion = FASTDDS_VERSION_STR;
#else
inline constexpr const char* kVersion = FASTRTPS_VERSION_STR;
#endif

using core::Duration_t;
inline constexpr std::int32_t kInfiniteSeconds = core::Time_t::INFINITE_SECONDS;
inline const Duration_t kForever{kInfiniteSeconds, core::Time_t::INFINITE_NANOSECONDS};
inline const Duration_t kNoTime{0, 0};

/// What an operation returned says that it was done. (In 2.9 some return a bool.)
#if BATON_FASTDDS == 3
[[nodiscard]] inline bool isDone(dds::ReturnCode_t result) { return result == dds::RETCODE_OK; }
#else
[[nodiscard]] inline bool isDone(const eprosima::fastrtps::types::ReturnCode_t& result) {
  return result == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}
[[nodiscard]] inline bool isDone(bool result) { return result; }
#endif

/// The times of a reliable endpoint that Baton sets.
struct WriterTimes {
  Duration_t& heartbeat_period;
  Duration_t& nack_response_delay;
  Duration_t& nack_suppression_duration;
};
struct ReaderTimes {
  Duration_t& initial_acknack_delay;
  Duration_t& heartbeat_response_delay;
};
#if BATON_FASTDDS == 3
[[nodiscard]] inline WriterTimes timesOf(dds::DataWriterQos& qos) {
  auto& times = qos.reliable_writer_qos().times;
  return {times.heartbeat_period, times.nack_response_delay, times.nack_supression_duration};
}
[[nodiscard]] inline ReaderTimes timesOf(dds::DataReaderQos& qos) {
  auto& times = qos.reliable_reader_qos().times;
  return {times.initial_acknack_delay, times.heartbeat_response_delay};
}
#else
[[nodiscard]] inline WriterTimes timesOf(dds::DataWriterQos& qos) {
  auto& times = qos.reliable_writer_qos().times;
  return {times.heartbeatPeriod, times.nackResponseDelay, times.nackSupressionDuration};
}
[[nodiscard]] inline ReaderTimes timesOf(dds::DataReaderQos& qos) {
  auto& times = qos.reliable_reader_qos().times;
  return {times.initialAcknackDelay, times.heartbeatResponseDelay};
}
#endif

/// A reader of bytes takes any encoding. (2.9 neither says so to the writer nor looks at what that one sends.)
inline void acceptAnyEncoding([[maybe_unused]] dds::DataReaderQos& qos) {
#if BATON_FASTDDS == 3
  qos.representation().m_value = {dds::XCDR_DATA_REPRESENTATION, dds::XCDR2_DATA_REPRESENTATION};
#endif
}

/// Sends no types and looks up none.
inline void propagateNoTypes(dds::DomainParticipantQos& qos) {
#if BATON_FASTDDS == 3
  qos.properties().properties().emplace_back(dds::parameter_policy_type_propagation, "disabled");
#else
  qos.wire_protocol().builtin.typelookup_config.use_client = false;
  qos.wire_protocol().builtin.typelookup_config.use_server = false;
#endif
}

/// From here on, participants of one process exchange everything through the transport as those of several do.
/// Otherwise Fast DDS 2.9.1 tells the readers of another participant of the process itself what it takes from a
/// history, also when that participant has been deleted and its farewell is still on its way: a segmentation fault.
inline void deliverThroughTheTransport() {
#if BATON_FASTDDS == 3
  eprosima::fastdds::LibrarySettings settings;
  settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  dds::DomainParticipantFactory::get_instance()->set_library_settings(settings);
#else
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
#endif
}

/// Creates a participant whose GUID prefix is what `introduce` makes of the one that the product chose, with what it
/// adds to the QoS, as far as that depends on the prefix. Returns nullptr when the product refuses.
inline dds::DomainParticipant* createParticipant(
    int domain, dds::DomainParticipantQos qos, dds::DomainParticipantListener* listener,
    const std::function<void(rtps::GuidPrefix_t&, dds::DomainParticipantQos&)>& introduce) {
  [[maybe_unused]] static const bool is_first = (deliverThroughTheTransport(), true);
  // A participant that is not enabled yet has a prefix and can be given another.
  auto* const factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipantFactoryQos factory_qos;
  factory->get_qos(factory_qos);
  factory_qos.entity_factory().autoenable_created_entities = false;
  factory->set_qos(factory_qos);
  auto* const participant =
      factory->create_participant(static_cast<std::uint32_t>(domain), qos, listener, dds::StatusMask::none());
  if (participant == nullptr) return nullptr;
  const rtps::GuidPrefix_t chosen = participant->guid().guidPrefix;
  rtps::GuidPrefix_t prefix = chosen;
  introduce(prefix, qos);
  if (prefix != chosen) qos.wire_protocol().prefix = prefix;
  if (isDone(participant->set_qos(qos)) && isDone(participant->enable())) return participant;
  factory->delete_participant(participant);
  return nullptr;
}

/// What discovery tells of a participant.
struct ParticipantData {
  rtps::GUID_t guid;
  std::vector<std::uint8_t> user_data;
};

/// What it tells of a writer.
#if BATON_FASTDDS == 3
using PublicationData = rtps::PublicationBuiltinTopicData;
#else
struct PublicationData {
  std::string topic_name;
  std::string type_name;
  rtps::TopicKind_t topic_kind;
  rtps::GUID_t guid;
  dds::DurabilityQosPolicy durability;
  dds::DeadlineQosPolicy deadline;
  dds::LatencyBudgetQosPolicy latency_budget;
  dds::LivelinessQosPolicy liveliness;
  dds::ReliabilityQosPolicy reliability;
  dds::LifespanQosPolicy lifespan;
  dds::OwnershipQosPolicy ownership;
  dds::OwnershipStrengthQosPolicy ownership_strength;
  dds::DestinationOrderQosPolicy destination_order;
  dds::PresentationQosPolicy presentation;
  dds::PartitionQosPolicy partition;
};
#endif

/// Discovery as Baton listens to it.
class DiscoveryListener : public dds::DomainParticipantListener {
 public:
  virtual void onParticipant(const ParticipantData& data) = 0;  // it is new, or has changed
  virtual void onParticipantGone(const rtps::GUID_t& guid) = 0;
  virtual void onWriter(const PublicationData& data) = 0;  // likewise
  virtual void onWriterGone(const rtps::GUID_t& guid) = 0;

#if BATON_FASTDDS == 3
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryStatus reason,
                                const dds::ParticipantBuiltinTopicData& info, bool&) final {
    using Status = rtps::ParticipantDiscoveryStatus;
    if (reason != Status::DISCOVERED_PARTICIPANT && reason != Status::CHANGED_QOS_PARTICIPANT) {
      onParticipantGone(info.guid);
    } else {
      onParticipant({info.guid, { info.user_data.begin(), info.user_data.end() }});
    }
  }
  void on_data_writer_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryStatus reason,
                                const PublicationData& info, bool&) final {
    if (reason == rtps::WriterDiscoveryStatus::REMOVED_WRITER) {
      onWriterGone(info.guid);
    } else {
      onWriter(info);
    }
  }
#else
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) final {
    using Status = rtps::ParticipantDiscoveryInfo;
    if (info.status != Status::DISCOVERED_PARTICIPANT && info.status != Status::CHANGED_QOS_PARTICIPANT) {
      onParticipantGone(info.info.m_guid);
    } else {
      const auto& data = info.info.m_userData;
      onParticipant({info.info.m_guid, {data.begin(), data.end()}});
    }
  }
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) final {
    if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
      onWriterGone(info.info.guid());
      return;
    }
    const auto& qos = info.info.m_qos;
    onWriter({.topic_name = info.info.topicName().to_string(),
              .type_name = info.info.typeName().to_string(),
              .topic_kind = info.info.topicKind(),
              .guid = info.info.guid(),
              .durability = qos.m_durability,
              .deadline = qos.m_deadline,
              .latency_budget = qos.m_latencyBudget,
              .liveliness = qos.m_liveliness,
              .reliability = qos.m_reliability,
              .lifespan = qos.m_lifespan,
              .ownership = qos.m_ownership,
              .ownership_strength = qos.m_ownershipStrength,
              .destination_order = qos.m_destinationOrder,
              .presentation = qos.m_presentation,
              .partition = qos.m_partition});
  }
#endif
};

/// A type support that moves bytes; it knows no keys and advertises no type objects. What is received on a keyed topic
/// without the hash of its key is of one instance: DDS would keep it for ever otherwise, and never hand it out.
class BytesType : public dds::TopicDataType {
 public:
  BytesType(const std::string& type_name, std::uint32_t max_size, bool keyed) {
#if BATON_FASTDDS == 3
    set_name(type_name);
    max_serialized_type_size = max_size;
    is_compute_key_provided = keyed;
#else
    setName(type_name.c_str());
    m_typeSize = max_size;
    m_isGetKeyDefined = keyed;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
#endif
  }

  [[nodiscard]] virtual bool put(const void* data, rtps::SerializedPayload_t& payload) const = 0;
  [[nodiscard]] virtual bool take(const rtps::SerializedPayload_t& payload, void* data) const = 0;
  [[nodiscard]] virtual std::uint32_t sizeOf(const void* data) const = 0;
  [[nodiscard]] virtual void* make() const = 0;
  virtual void destroy(void* data) const = 0;
  /// Whether it was filled by take(), not given to put().
  [[nodiscard]] virtual bool isReceived(const void* data) const = 0;

  [[nodiscard]] static bool takeForOne(rtps::InstanceHandle_t& instance) {
    const rtps::GUID_t any(rtps::GuidPrefix_t{}, 1);
    instance = any;
    return true;
  }

#if BATON_FASTDDS == 3
  bool serialize(const void* const data, rtps::SerializedPayload_t& payload, dds::DataRepresentationId_t) final {
    return put(data, payload);
  }
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) final { return take(payload, data); }
  std::uint32_t calculate_serialized_size(const void* const data, dds::DataRepresentationId_t) final {
    return sizeOf(data);
  }
  void* create_data() final { return make(); }
  void delete_data(void* data) final { destroy(data); }
  bool compute_key(rtps::SerializedPayload_t&, rtps::InstanceHandle_t& instance, bool) final {
    return takeForOne(instance);
  }
  bool compute_key(const void* const, rtps::InstanceHandle_t&, bool) final { return false; }
#else
  bool serialize(void* data, rtps::SerializedPayload_t* payload) final { return put(data, *payload); }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) final { return take(*payload, data); }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) final {
    return [size = sizeOf(data)] { return size; };
  }
  void* createData() final { return make(); }
  void deleteData(void* data) final { destroy(data); }
  bool getKey(void* data, rtps::InstanceHandle_t* instance, bool) final {
    return isReceived(data) && takeForOne(*instance);
  }
#endif
};

/// A datagram as a transport is given it.
#if BATON_FASTDDS == 3
using Datagram = const std::vector<transport::NetworkBuffer>&;
#else
using Datagram = const rtps::octet*;
#endif

}  // namespace baton::fastdds
