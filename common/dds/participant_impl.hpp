/// The Fast DDS side of a participant. Private to common/dds.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <mutex>
#include <string>

#include "dds/participant.hpp"

namespace baton::dds {

struct Participant::Impl final : eprosima::fastdds::dds::DomainParticipantListener {
  Impl(const ParticipantOptions& options, PeerCallback on_peer_in);
  ~Impl() override;

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* who,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* who,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

  /// The topic of this name and type, created on first use and shared by readers and writers.
  eprosima::fastdds::dds::Topic* topic(const std::string& name, const std::string& type, std::uint32_t max_payload,
                                       bool keyed);

  PeerCallback on_peer;
  Peer self;
  eprosima::fastdds::dds::DomainParticipant* participant = nullptr;
  eprosima::fastdds::dds::Publisher* publisher = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber = nullptr;
  mutable std::mutex mutex;  // guards what follows; discovery runs on a DDS thread
  std::map<GuidPrefix, Peer> peers;
  std::map<Guid, DiscoveredWriter> writers;
  std::mutex watch_mutex;  // held while on_writer is called, so that it can be taken away; never taken after `mutex`
  WriterCallback on_writer;
};

[[nodiscard]] Guid toGuid(const eprosima::fastrtps::rtps::GUID_t& guid);

}  // namespace baton::dds
