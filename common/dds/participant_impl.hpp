/// The Fast DDS side of a participant. Private to common/dds.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "dds/fastdds.hpp"
#include "dds/participant.hpp"

namespace baton::dds {

struct Participant::Impl final : fastdds::DiscoveryListener {
  Impl(const ParticipantOptions& options, PeerCallback on_peer_in, Gate::Tell on_trespass);
  ~Impl() override;

  void onParticipant(const fastdds::ParticipantData& data) override;
  void onParticipantGone(const fastdds::rtps::GUID_t& guid) override;
  void onWriter(const fastdds::PublicationData& data) override;
  void onWriterGone(const fastdds::rtps::GUID_t& guid) override;

  /// Takes a participant away; of a member it is remembered. Under `mutex`.
  void forget(const GuidPrefix& prefix);

  /// The topic of this name and type, created on first use and shared by readers and writers. Throws UsageError when
  /// the name is another type's, or the type is there with a key and is wanted without, or the other way round.
  fastdds::dds::Topic* topic(const std::string& name, const std::string& type, std::uint32_t max_payload, bool keyed);

  PeerCallback on_peer;
  std::optional<RunKey> key;
  std::shared_ptr<Gate> gate;  // where there is a key
  const WallClock clock;
  Peer self;
  std::uint64_t announcements = 0;
  fastdds::dds::DomainParticipant* participant = nullptr;
  fastdds::dds::Publisher* publisher = nullptr;
  fastdds::dds::Subscriber* subscriber = nullptr;
  std::atomic<std::uint64_t> departures = 0;
  mutable std::mutex mutex;  // guards what follows; discovery runs on a DDS thread
  std::map<GuidPrefix, Peer> peers;
  std::map<GuidPrefix, Peer> strangers;  // some of them
  std::map<GuidPrefix, Peer> departed;   // members that have left
  std::map<Guid, DiscoveredWriter> writers;
  std::map<std::string, bool> is_keyed;  // by type
  std::mutex watch_mutex;  // held while on_writer is called, so that it can be taken away; never taken after `mutex`
  WriterCallback on_writer;
};

[[nodiscard]] Guid toGuid(const fastdds::rtps::GUID_t& guid);

}  // namespace baton::dds
