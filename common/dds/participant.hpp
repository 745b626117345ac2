/// One process's membership in a DDS domain: discovery settings, transport, and who else is there.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dds/gate.hpp"
#include "dds/interfaces.hpp"
#include "dds/run_key.hpp"
#include "dds/types.hpp"
#include "dds/wall_clock.hpp"

namespace baton::dds {

struct ParticipantOptions {
  int domain = 0;         // 0 to 232
  std::string partition;  // "cell/run": endpoints in other partitions are never matched; may be a pattern for observers
  std::vector<std::string> other_partitions{};    // writers are heard in these as well; "": where no partition is set
  std::vector<std::string> also_read{};           // readers match writers in these as well, likewise; may be patterns
  std::vector<std::string> addresses{kLoopback};  // IPv4, of the interfaces it uses; empty: all of this machine
  int lease_s = 3600;                             // how long the others take it for alive after its last word
  std::string cell;                               // the cell this process belongs to, empty for observers of any
  std::vector<std::string> other_cells{};         // to find at once; any other is found when it announces itself again
  std::string run;      // the run within the cell; what is left over from another run is told apart by this
  std::string service;  // name of the service, unique in the run
  Role role = Role::kOperator;
  Transport transport = Transport::kUdp;
  std::optional<RunKey> key{};  // of the run; without one, everybody is heard and taken for who they say they are
  Strangers strangers = Strangers::kAsk;  // where there is a key
  WallClock clock{};                      // of the run: what is sent has its time stamps
};

/// A process of Baton in the domain, as its discovery data tell.
struct Peer {
  std::string cell;
  std::string run;
  std::string service;
  std::int64_t started_ns = 0;  // since the epoch, by the clock of its run
  int pid = 0;
  std::uint64_t process_began = 0;  // in the kernel's ticks since it booted; 0: not known. A process id comes again
  std::string proof{};              // that all this was said by who has the key of that run; empty where it has none
  GuidPrefix prefix{};
  bool is_stranger = false;  // says that it is of our run, or bears its mark, and cannot prove it
  bool operator==(const Peer&) const = default;
};
/// The same answer in every process that asks. Clocks of different hosts must agree better than people start things.
[[nodiscard]] bool isElder(const Peer& a, const Peer& b);
/// Whether it has said what it says with this key, of its run.
[[nodiscard]] bool isProven(const Peer& peer, const RunKey& key);

/// A writer somebody has, ours or not, found by discovery.
struct DiscoveredWriter {
  Guid guid;
  std::string topic;
  std::string type;
  bool keyed = false;
  bool exclusive_ownership = false;
  bool reliable = false;
  bool transient_local = false;
  std::vector<std::string> partitions;
  std::string qos_text;  // "policy: value" lines, for the recording's metadata
};

/// The IPv4 multicast group in which the members of a cell find each other.
[[nodiscard]] std::string discoveryGroup(const std::string& cell);

/// Called on a DDS thread: hand it to the executor and return.
using PeerCallback = std::function<void(const Peer&)>;
using WriterCallback = std::function<void(const DiscoveredWriter&)>;

/// Owns the participant, a publisher and a subscriber in the partition. Everything made from it must be destroyed
/// before it.
class Participant {
 public:
  /// @param on_peer  called for every Baton process that joins, strangers too.
  /// @param on_trespass  called for what is turned away.
  /// Throws UsageError for a domain outside 0 to 232 and UnavailableError when no interface is up or DDS refuses.
  explicit Participant(const ParticipantOptions& options, PeerCallback on_peer = {}, Gate::Tell on_trespass = {});
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// The Baton process that has this GUID prefix, if discovery has told. Strangers are none.
  [[nodiscard]] std::optional<Peer> peer(const GuidPrefix& prefix) const;
  /// The same, when it has our run's key: who claims another run is no stranger and may still be in our partition.
  [[nodiscard]] std::optional<Peer> member(const GuidPrefix& prefix) const;
  [[nodiscard]] std::vector<Peer> peers() const;
  /// What a stranger calls itself, if discovery has told.
  [[nodiscard]] std::optional<Peer> stranger(const GuidPrefix& prefix) const;
  [[nodiscard]] bool hasKey() const;
  /// What a participant is in our run, by the mark of its prefix: nothing for one of another run, one that cannot prove
  /// what it says of itself, and one that has left or was buried, since who comes under its prefix later is another.
  /// Nothing, where we have no key. Who copies the prefix and the words of one that is alive is not told from it.
  [[nodiscard]] std::optional<Role> roleOf(const GuidPrefix& prefix) const;
  /// Whether it is of our run. Everybody is, where we have no key.
  [[nodiscard]] bool isMember(const GuidPrefix& prefix) const;
  /// RTPS messages of strangers that DDS was not given.
  [[nodiscard]] std::uint64_t turnedAway() const;
  /// Its process has ended without a farewell.
  void bury(const GuidPrefix& prefix);
  /// A member that has left or was buried, as it was.
  [[nodiscard]] std::optional<Peer> departed(const GuidPrefix& prefix) const;
  /// How many members have left or were buried, but for operators: while this is the same, so is what roleOf() says of
  /// the others.
  [[nodiscard]] std::uint64_t departures() const;
  /// Whether a sample comes from a second copy of a service that has not given way yet. Not for services that may be
  /// started again, in a run without a key: there a process that was killed is remembered for the length of its lease.
  [[nodiscard]] bool isSecondCopy(const Guid& writer) const;
  /// What is sent has its time stamps.
  [[nodiscard]] const WallClock& clock() const;
  /// This process as others see it.
  [[nodiscard]] const Peer& self() const;
  /// Tells everybody once more that it is there: a datagram may have been lost. One thread at a time.
  void announce();

  /// Calls back for every writer of somebody else in the domain, those known already first, until another callback or
  /// an empty one takes its place: no call is under way any more when this returns. Not to be called from a callback.
  void watchWriters(WriterCallback callback);
  /// Those that have not been withdrawn, by anybody else in the domain.
  [[nodiscard]] std::vector<DiscoveredWriter> writers() const;

  struct Impl;  // Fast DDS entities, for the other files of this folder
  [[nodiscard]] Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// The DDS product and its version, as in "Fast DDS 2.9.1".
[[nodiscard]] std::string productName();

/// Sends what the DDS product logs to `sink` (level 0 error, 1 warning) instead of standard output.
void redirectDdsLog(std::function<void(int level, const std::string& text)> sink);

}  // namespace baton::dds
