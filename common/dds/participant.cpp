#include "dds/participant.hpp"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <span>
#include <sstream>
#include <tuple>

#include "base/error.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "dds/environment.hpp"
#include "dds/fastdds.hpp"
#include "dds/gated_transport.hpp"
#include "dds/hash.hpp"
#include "dds/interfaces.hpp"
#include "dds/lossy_transport.hpp"
#include "dds/participant_impl.hpp"
#include "dds/process.hpp"
#include "dds/raw_type.hpp"

namespace baton::dds {
namespace {
using namespace fastdds::dds;
namespace rtps = fastdds::rtps;
namespace transport = fastdds::transport;

constexpr int kMaxDomain = 232;
constexpr std::size_t kMaxKnown = 10'000;  // of peers, and of strangers: a flood of them must not fill the memory
constexpr std::size_t kMaxNames = 300;     // bytes of a peer's cell, run and service together
constexpr int kSocketBuffer = 4 << 20;     // loopback UDP loses datagrams when a busy receiver's buffer is full

// Discovery data of a Baton process: one field a line, then the proof of them.
std::string fieldsOf(const Peer& peer) {
  return "baton\n" + peer.cell + "\n" + peer.run + "\n" + peer.service + "\n" + std::to_string(peer.started_ns) + "\n" +
         std::to_string(peer.pid) + "\n" + std::to_string(peer.process_began) + "\n";
}

std::string encodePeer(const Peer& peer) { return fieldsOf(peer) + peer.proof; }

std::optional<Peer> decodePeer(const std::string& text, const GuidPrefix& prefix) {
  std::istringstream lines(text);
  std::string tag;
  Peer peer;
  peer.prefix = prefix;
  if (!std::getline(lines, tag) || tag != "baton") return std::nullopt;
  std::getline(lines, peer.cell);
  std::getline(lines, peer.run);
  std::getline(lines, peer.service);
  lines >> peer.started_ns >> peer.pid >> peer.process_began;
  // They are shown in logs and on terminals, and remembered. Ours have no such characters, and are short.
  const std::string names = peer.cell + peer.run + peer.service;
  if (lines.fail() || !isPlain(names) || names.size() > kMaxNames) return std::nullopt;
  std::getline(lines, tag);  // what is left of the line
  std::getline(lines, peer.proof);
  return peer;
}

/// BATON_LOSE_ONE_IN=N in the environment: of N datagrams sent one, on average, is thrown away, to show what a bad
/// network does to a run. 0 without it.
std::uint64_t loseOneIn() {
  const char* text = std::getenv("BATON_LOSE_ONE_IN");
  if (text == nullptr) return 0;
  const auto one_in = numberIn<std::uint64_t>(text);
  if (!one_in || *one_in < 2) {
    throw UsageError(std::string("BATON_LOSE_ONE_IN: expected a whole number from 2, found ") + text);
  }
  return *one_in;
}

std::shared_ptr<transport::TransportDescriptorInterface> udpOn(const std::vector<std::string>& addresses) {
  auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = addresses;  // an empty list opens every interface of the machine
  udp->sendBufferSize = kSocketBuffer;
  udp->receiveBufferSize = kSocketBuffer;
  return udp;
}

std::vector<std::string> addressesOfAll() {
  std::vector<std::string> addresses;
  for (const Interface& one : interfaces()) addresses.push_back(one.address);
  return addresses;
}

/// Port 0: the one that RTPS has for it.
rtps::Locator_t locatorOf(const std::string& address, std::uint32_t port = 0) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = port;
  (void)inet_pton(AF_INET, address.c_str(), &locator.address[12]);
  return locator;
}

/// Where a participant announces itself and listens for others. Each discovers each: in one group, the work would grow
/// with the square of all processes of all cells. So the members of a cell listen in their group. All announce
/// themselves in the group of RTPS as well, where every other program listens, and those of ours that read or write in
/// other cells; who finds a member there answers it directly. (None listens in both groups: Fast DDS binds one socket a
/// port, to the first group.) Two cells with the same group find each other, which is only slower.
void discoverIn(const ParticipantOptions& options, const std::vector<std::string>& addresses,
                DomainParticipantQos& qos) {
  const std::uint32_t port = 7400 + 250 * static_cast<std::uint32_t>(options.domain);  // RTPS 2.5, 9.6.2.3
  const rtps::Locator_t group_of_all = locatorOf("239.255.0.1", port),
                        own = locatorOf(discoveryGroup(options.cell), port);
  const bool is_a_member = !options.cell.empty();
  const bool keeps_to_its_cell = is_a_member && options.other_partitions.empty() && options.also_read.empty();
  auto& builtin = qos.wire_protocol().builtin;
  builtin.metatrafficMulticastLocatorList.push_back(keeps_to_its_cell ? own : group_of_all);
  // Not port 0 here: as initial peers those would be the ports of the first four participants.
  builtin.initialPeersList.push_back(group_of_all);
  if (is_a_member) builtin.initialPeersList.push_back(own);
  for (const std::string& cell : options.other_cells) {
    builtin.initialPeersList.push_back(locatorOf(discoveryGroup(cell), port));
  }
  // Once one locator of discovery is given, Fast DDS adds none, also not of shared memory: discovery is by UDP.
  for (const std::string& address : addresses) builtin.metatrafficUnicastLocatorList.push_back(locatorOf(address));
  if (addresses.size() == 1) return;
  // Of several, Fast DDS would leave the loopback out, the one address at which those who are on the loopback alone, as
  // Baton's own processes are, can send to it.
  for (const std::string& address : addresses) {
    qos.wire_protocol().default_unicast_locator_list.push_back(locatorOf(address));
  }
}

/// "name: value" lines for what a writer promises beyond the usual; nothing for what it does not.
std::string promisesText(const fastdds::PublicationData& qos) {
  const auto line = [](const char* name, const fastdds::Duration_t& duration) {
    return duration == fastdds::kForever ? "" : name + std::to_string(duration.to_ns()) + "\n";
  };
  std::string text = line("deadline_ns: ", qos.deadline.period);
  if (qos.liveliness.kind == MANUAL_BY_PARTICIPANT_LIVELINESS_QOS) text += "liveliness: manual_by_participant\n";
  if (qos.liveliness.kind == MANUAL_BY_TOPIC_LIVELINESS_QOS) text += "liveliness: manual_by_topic\n";
  text += line("lease_ns: ", qos.liveliness.lease_duration);
  if (qos.ownership.kind == EXCLUSIVE_OWNERSHIP_QOS) {
    text += "ownership_strength: " + std::to_string(qos.ownership_strength.value) + "\n";
  }
  return text;
}

/// "policy: value" lines for what no reader of ours asks for; nothing for what is as it is by default.
std::string policiesText(const fastdds::PublicationData& qos) {
  std::string text;
  if (const auto& life = qos.lifespan.duration; life != fastdds::kForever) {
    text += "lifespan_ns: " + std::to_string(life.to_ns()) + "\n";
  }
  if (const auto& budget = qos.latency_budget.duration; budget != fastdds::kNoTime) {
    text += "latency_budget_ns: " + std::to_string(budget.to_ns()) + "\n";
  }
  if (qos.destination_order.kind == BY_SOURCE_TIMESTAMP_DESTINATIONORDER_QOS) {
    text += "destination_order: by_source_timestamp\n";
  }
  if (qos.presentation.access_scope == TOPIC_PRESENTATION_QOS) text += "presentation: topic\n";
  if (qos.presentation.access_scope == GROUP_PRESENTATION_QOS) text += "presentation: group\n";
  for (const std::string& partition : qos.partition.getNames()) text += "partition: " + partition + "\n";
  return text;
}

GuidPrefix toPrefix(const rtps::GUID_t& guid) { return prefixOf(toGuid(guid)); }

void say(const std::string& data, DomainParticipantQos& qos) { qos.user_data().data_vec({data.begin(), data.end()}); }

DomainParticipantQos participantQos(const ParticipantOptions& options, const std::shared_ptr<Gate>& gate) {
  DomainParticipantQos qos = DomainParticipantFactory::get_instance()->get_default_participant_qos();
  qos.name(options.service);

  qos.transport().use_builtin_transports = false;
  const std::uint64_t one_in = loseOneIn();
  const auto udp = udpOn(options.addresses);
  const auto way = one_in > 0 ? losing(one_in, udp) : udp;
  qos.transport().user_transports.push_back(gate ? gated(gate, way) : way);
  discoverIn(options, options.addresses.empty() ? addressesOfAll() : options.addresses, qos);
  if (options.transport == Transport::kSharedMemory) {
    // Without a gate: Fast DDS finds this transport by the type of its descriptor, and would not use it.
    qos.transport().user_transports.push_back(std::make_shared<transport::SharedMemTransportDescriptor>());
  }

  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  // DDS answers a new member of the cell at once; the period is for lost datagrams, and for participants that send
  // nothing to the cell's group. Each participant sends to every other, so the traffic grows with the square of their
  // number. A service that still waits for a peer calls announce(). The lease is longer than any stop of a process
  // (SIGSTOP); the supervisor notices processes that end, not DDS. Another reason for a long lease: Fast DDS 2.9.1
  // checks a lease once per lease duration, and an assertion ends the process when its participant leaves during the
  // check.
  discovery.leaseDuration_announcementperiod = {3, 0};
  discovery.leaseDuration = {options.lease_s, 0};
  discovery.initial_announcements.count = 5;
  discovery.initial_announcements.period = {0, 20'000'000};
  fastdds::propagateNoTypes(qos);
  return qos;
}

[[noreturn]] void refuse(const std::string& what) {
  throw UnavailableError("DDS could not create " + what +
                         ": expected UDP (on the loopback, 127.0.0.1, unless another interface was asked for) to be "
                         "usable and memory to be free; check both and retry");
}
}  // namespace

std::string discoveryGroup(const std::string& cell) {
  const std::uint64_t hash = chainHash(0, std::as_bytes(std::span(cell)));  // the same on every host
  return "239.255." + std::to_string(1 + hash / 254 % 254) + "." + std::to_string(1 + hash % 254);
}

Guid toGuid(const rtps::GUID_t& guid) {
  Guid result;
  std::copy_n(guid.guidPrefix.value, 12, result.bytes.begin());
  std::copy_n(guid.entityId.value, 4, result.bytes.begin() + 12);
  return result;
}

Participant::Impl::Impl(const ParticipantOptions& options, PeerCallback on_peer_in, Gate::Tell on_trespass)
    : on_peer(std::move(on_peer_in)),
      key(options.key),
      gate(key ? std::make_shared<Gate>(*key, options.strangers, std::move(on_trespass)) : nullptr),
      clock(options.clock) {
  if (options.domain < 0 || options.domain > kMaxDomain) {
    throw UsageError("DDS domain: expected 0 to 232, found " + std::to_string(options.domain));
  }
  expectUp(options.addresses, interfaces());
  [[maybe_unused]] static const bool is_first = (ignoreForeignSettings(), true);
  self = {.cell = options.cell,
          .run = options.run,
          .service = options.service,
          .started_ns = clock.now(),
          .pid = getpid(),
          .process_began = processBegan(getpid())};
  const auto introduce = [&](rtps::GuidPrefix_t& prefix, DomainParticipantQos& qos) {
    std::copy_n(prefix.value, self.prefix.size(), self.prefix.begin());
    if (key) {
      self.prefix = key->marked(self.prefix, options.role);
      self.proof = key->proofOf(self.prefix, fieldsOf(self));
      std::ranges::copy(self.prefix, prefix.value);
    }
    say(encodePeer(self), qos);
  };
  participant = fastdds::createParticipant(options.domain, participantQos(options, gate), this, introduce);
  if (participant == nullptr) refuse("a participant in domain " + std::to_string(options.domain));
  PublisherQos publisher_qos = participant->get_default_publisher_qos();
  SubscriberQos subscriber_qos = participant->get_default_subscriber_qos();
  publisher_qos.partition().push_back(options.partition.c_str());
  subscriber_qos.partition().push_back(options.partition.c_str());
  for (const std::string& other : options.other_partitions) publisher_qos.partition().push_back(other.c_str());
  for (const std::string& other : options.also_read) subscriber_qos.partition().push_back(other.c_str());
  publisher = participant->create_publisher(publisher_qos);
  subscriber = participant->create_subscriber(subscriber_qos);
  if (publisher == nullptr || subscriber == nullptr) refuse("a publisher and a subscriber");
}

Participant::Impl::~Impl() {
  // Stops discovery callbacks first: they use members of this object.
  participant->set_listener(nullptr);
  participant->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant);
}

void Participant::Impl::forget(const GuidPrefix& prefix) {
  strangers.erase(prefix);
  const auto known = peers.extract(prefix);
  const auto role = key ? key->roleOf(prefix) : std::nullopt;
  if (!role || !departed.try_emplace(prefix, known.empty() ? Peer{} : known.mapped()).second) return;
  if (role != Role::kOperator) ++departures;
}

void Participant::Impl::onParticipantGone(const rtps::GUID_t& guid) {
  const std::lock_guard lock(mutex);
  forget(toPrefix(guid));
}

void Participant::Impl::onParticipant(const fastdds::ParticipantData& data) {
  const GuidPrefix prefix = toPrefix(data.guid);
  const std::optional<Role> role = key ? key->roleOf(prefix) : std::nullopt;  // as the mark in the prefix says
  std::optional<Peer> peer = decodePeer({data.user_data.begin(), data.user_data.end()}, prefix);
  if (!peer && !role) return;
  if (!peer) peer.emplace().prefix = prefix;
  const bool is_ours = peer->cell == self.cell && peer->run == self.run;
  const bool is_member = role && is_ours && isProven(*peer, *key);
  peer->is_stranger = key && (is_ours || role) && !is_member;
  {
    const std::lock_guard lock(mutex);
    if (departed.contains(prefix)) return;  // an announcement that comes late, or an heir's: nobody hears it
    auto& known = peer->is_stranger ? strangers : peers;
    if (const auto found = known.find(prefix); found != known.end() && found->second == *peer) return;  // said again
    if (role && peers.contains(prefix)) return;  // a member is who it was when it came
    // Who was a service of our run and is dead when we first hear of it is another, under its GUID.
    if (is_member && role != Role::kOperator && !isRunning(peer->pid, peer->process_began)) {
      departed.emplace(prefix, *peer);
      ++departures;
      return;
    }
    if (role || known.size() < kMaxKnown) known[prefix] = *peer;  // marks cannot be made in number
    if (!peer->is_stranger) strangers.erase(prefix);
  }
  if (on_peer) on_peer(*peer);
}

void Participant::Impl::onWriterGone(const rtps::GUID_t& guid) {
  const std::lock_guard watch_lock(watch_mutex);
  const std::lock_guard lock(mutex);
  writers.erase(toGuid(guid));
}

void Participant::Impl::onWriter(const fastdds::PublicationData& data) {
  const std::lock_guard watch_lock(watch_mutex);
  DiscoveredWriter writer{.guid = toGuid(data.guid),
                          .topic = std::string(data.topic_name),
                          .type = std::string(data.type_name),
                          .keyed = data.topic_kind == rtps::WITH_KEY,
                          .exclusive_ownership = data.ownership.kind == EXCLUSIVE_OWNERSHIP_QOS,
                          .reliable = data.reliability.kind == RELIABLE_RELIABILITY_QOS,
                          .transient_local = data.durability.kind >= TRANSIENT_LOCAL_DURABILITY_QOS,
                          .partitions = {},
                          .qos_text = {}};
  for (const auto& partition : data.partition.getNames()) writer.partitions.emplace_back(partition);
  writer.qos_text = std::string("reliability: ") + (writer.reliable ? "reliable" : "best_effort") +
                    "\ndurability: " + (writer.transient_local ? "transient_local" : "volatile") +
                    "\nownership: " + (writer.exclusive_ownership ? "exclusive" : "shared") +
                    "\nkeyed: " + (writer.keyed ? "true" : "false") + "\n" + promisesText(data) + policiesText(data);
  {
    const std::lock_guard lock(mutex);
    writers[writer.guid] = writer;
  }
  if (on_writer) on_writer(writer);
}

Topic* Participant::Impl::topic(const std::string& name, const std::string& type, std::uint32_t max_payload,
                                bool keyed) {
  const std::lock_guard lock(mutex);
  if (is_keyed.try_emplace(type, keyed).first->second != keyed) {
    const auto with = [](bool has_key) { return has_key ? "with a key" : "without a key"; };
    throw UsageError("topic " + name + ": expected type " + type + ' ' + with(!keyed) + ", found it " + with(keyed));
  }
  if (auto* description = participant->lookup_topicdescription(name)) {
    if (description->get_type_name() != type) {
      throw UsageError("topic " + name + ": expected type " + description->get_type_name() + ", found " + type);
    }
    return static_cast<Topic*>(description);
  }
  TypeSupport support(new RawType(type, max_payload, keyed));
  support.register_type(participant);  // says no to the second of a name, which is the same
  Topic* created = participant->create_topic(name, type, participant->get_default_topic_qos());
  if (created == nullptr) refuse("topic " + name);
  return created;
}

Participant::Participant(const ParticipantOptions& options, PeerCallback on_peer, Gate::Tell on_trespass)
    : impl_(std::make_unique<Impl>(options, std::move(on_peer), std::move(on_trespass))) {}

Participant::~Participant() = default;

std::optional<Peer> Participant::peer(const GuidPrefix& prefix) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->peers.find(prefix);
  return found == impl_->peers.end() ? std::nullopt : std::optional(found->second);
}

std::optional<Peer> Participant::member(const GuidPrefix& prefix) const {
  return isMember(prefix) ? peer(prefix) : std::nullopt;
}

std::optional<Peer> Participant::stranger(const GuidPrefix& prefix) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->strangers.find(prefix);
  return found == impl_->strangers.end() ? std::nullopt : std::optional(found->second);
}

bool Participant::hasKey() const { return impl_->key.has_value(); }

std::optional<Role> Participant::roleOf(const GuidPrefix& prefix) const {
  if (!impl_->key) return std::nullopt;
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->departed.contains(prefix) || impl_->strangers.contains(prefix)) return std::nullopt;
  }
  return impl_->key->roleOf(prefix);
}

std::uint64_t Participant::turnedAway() const { return impl_->gate ? impl_->gate->turnedAway() : 0; }

bool Participant::isMember(const GuidPrefix& prefix) const { return !impl_->key || roleOf(prefix).has_value(); }

void Participant::bury(const GuidPrefix& prefix) {
  const std::lock_guard lock(impl_->mutex);
  impl_->forget(prefix);
}

std::optional<Peer> Participant::departed(const GuidPrefix& prefix) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->departed.find(prefix);
  return found == impl_->departed.end() ? std::nullopt : std::optional(found->second);
}

std::uint64_t Participant::departures() const { return impl_->departures; }

std::vector<Peer> Participant::peers() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<Peer> result;
  for (const auto& [prefix, peer] : impl_->peers) result.push_back(peer);
  return result;
}

bool Participant::isSecondCopy(const Guid& writer) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->peers.find(prefixOf(writer));
  if (found == impl_->peers.end()) return false;
  const Peer& peer = found->second;
  return std::any_of(impl_->peers.begin(), impl_->peers.end(), [&](const auto& entry) {
    const Peer& other = entry.second;
    return other.cell == peer.cell && other.run == peer.run && other.service == peer.service && isElder(other, peer);
  });
}

const WallClock& Participant::clock() const { return impl_->clock; }
const Peer& Participant::self() const { return impl_->self; }

void Participant::announce() {
  // DDS sends changed user data to every participant. decodePeer() ignores what follows the last field.
  DomainParticipantQos qos = impl_->participant->get_qos();
  say(encodePeer(impl_->self) + "\n" + std::to_string(++impl_->announcements), qos);
  impl_->participant->set_qos(qos);
}

bool isProven(const Peer& peer, const RunKey& key) {
  return key.roleOf(peer.prefix) && key.proofOf(peer.prefix, fieldsOf(peer)) == peer.proof;
}

bool isElder(const Peer& a, const Peer& b) {
  return std::tie(a.started_ns, a.prefix) < std::tie(b.started_ns, b.prefix);
}

void Participant::watchWriters(WriterCallback callback) {
  const std::lock_guard watch_lock(impl_->watch_mutex);
  std::map<Guid, DiscoveredWriter> known;
  {
    const std::lock_guard lock(impl_->mutex);
    known = impl_->writers;
  }
  impl_->on_writer = std::move(callback);
  if (!impl_->on_writer) return;
  for (const auto& [guid, writer] : known) impl_->on_writer(writer);
}

std::vector<DiscoveredWriter> Participant::writers() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<DiscoveredWriter> result;
  for (const auto& [guid, writer] : impl_->writers) result.push_back(writer);
  return result;
}

std::string productName() { return std::string("Fast DDS ") + fastdds::kVersion; }

void redirectDdsLog(std::function<void(int level, const std::string& text)> sink) {
  struct Consumer final : LogConsumer {
    explicit Consumer(std::function<void(int, const std::string&)> s) : sink(std::move(s)) {}
    void Consume(const Log::Entry& entry) override { sink(entry.kind == Log::Kind::Error ? 0 : 1, entry.message); }
    std::function<void(int, const std::string&)> sink;
  };
  Log::ClearConsumers();
  Log::RegisterConsumer(std::make_unique<Consumer>(std::move(sink)));
}

}  // namespace baton::dds
