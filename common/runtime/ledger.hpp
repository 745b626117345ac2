/// What was received from each writer, held against what the writers say they sent: the recording's completeness
/// certificate. The recorder keeps one while it records; who reads a recording can keep one again, from its bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dds/types.hpp"
#include "msg/service.h"

namespace baton {

/// One writer on one topic, as received.
struct ReceivedStream {
  std::uint64_t first_sequence = 0;
  std::uint64_t last_sequence = 0;
  std::uint64_t count = 0;
  std::uint64_t missing = 0;  // holes between first and last, and what found no room
  std::uint64_t dropped = 0;  // of these, what found no room
  std::uint64_t excused = 0;  // of neverRecorded(): lost before the judged file began
  std::uint64_t stream_hash = 0;

  /// What was sent up to the last sample that came, and is not recorded: what is missing, and all before the first.
  [[nodiscard]] std::uint64_t neverRecorded() const { return missing + (first_sequence > 0 ? first_sequence - 1 : 0); }
};

class Ledger {
 public:
  using Key = std::pair<std::string, dds::Guid>;  // topic, writer

  /// @param services who has to send a manifest at the end.
  explicit Ledger(std::vector<std::string> services) : services_(services.begin(), services.end()) {}

  /// One stream's account: found once, for all its samples. Lives as long as the ledger.
  using Stream = std::map<Key, ReceivedStream>::value_type;
  [[nodiscard]] Stream& streamOf(const Key& key) { return *streams_.try_emplace(key).first; }

  /// Samples of a stream that never came, or came and found no room.
  struct Gap {
    Key stream;
    std::uint64_t first_sequence = 0;
    std::uint64_t last_sequence = 0;
    std::string reason;
  };
  static constexpr std::size_t kMaxGaps = 1000;  // listed; the rest is counted

  /// Books a sample; what manifests and the status of services say of who vouches for what is noted. Returns false for
  /// one that came already (it is not to be recorded again).
  bool book(Stream& booked, std::uint64_t sequence, std::span<const std::byte> payload);
  bool book(const Key& key, std::uint64_t sequence, std::span<const std::byte> payload) {
    return book(streamOf(key), sequence, payload);
  }
  /// These came and found no room.
  void dropped(Stream& booked, std::uint64_t first_sequence, std::uint64_t last_sequence);
  /// Of these none is missing: they had no data, or their writer had replaced them before it was found.
  void passOver(Stream& booked, std::uint64_t first_sequence, std::uint64_t last_sequence);
  /// The account is that of a run: what is lost on foreign topics, those that are none of Baton's, is remarked from now
  /// on. It takes nothing from the verdict, which is on the run.
  void remarkForeignTopics() { are_foreign_remarked_ = true; }
  /// Nothing is asked about this topic: it is left out on purpose.
  void leaveOut(const std::string& topic) { left_out_.insert(topic); }
  /// Something of this topic that ought to be in the recording cannot be.
  void cannotRecord(const std::string& topic, const std::string& what) { unrecordable_.insert({topic, what}); }
  /// The same of no topic in particular.
  void cannotRecord(const std::string& what) { lacks_.insert(what); }
  void addManifest(const msg::ServiceManifest& manifest);

  /// Another service has joined, of whom a manifest is to be expected.
  void expect(const std::string& service) { services_.insert(service); }
  [[nodiscard]] bool expects(const std::string& service) const { return services_.contains(service); }
  /// The service has failed: its manifest will not come.
  void giveUpOn(const std::string& service) { given_up_.insert(service); }
  /// Nothing more is to be expected: every manifest that still can come has, and every stream they name is here, whole.
  [[nodiscard]] bool isSettled() const;
  /// Whether every writer of what the services count has a manifest; that of one that nobody waits for may still come.
  [[nodiscard]] bool isVouchedFor() const { return unvouched(vouchedFor()).empty(); }
  [[nodiscard]] bool isVouchedFor(const Key& stream) const { return vouchedFor().contains(stream); }
  /// Every service has sent its manifest, every stream is vouched for by one, and is here, whole.
  [[nodiscard]] bool isComplete() const { return problems().empty(); }
  /// One sentence for each thing that is missing.
  [[nodiscard]] std::vector<std::string> problems() const;
  /// The same in the middle of a run, when nobody has said what was sent: what came has to be without gaps.
  [[nodiscard]] std::vector<std::string> problemsSoFar() const;
  /// One sentence for each thing that is missing of foreign topics, when these are remarked.
  [[nodiscard]] std::vector<std::string> remarks() const;
  [[nodiscard]] bool isRemarked(const std::string& topic) const;
  /// The certificate as JSON text: verdict, problems, one row a stream.
  [[nodiscard]] std::string certificate() const;
  /// What a certificate says is not in the files on purpose is not missed in them: topics, pauses, what came before
  /// they begin or after they end. Of what cannot be counted again it says what came, and is believed.
  void excuse(const std::string& certificate);
  /// The sum over a stream's payloads begins with this one: what came before is gone, on purpose.
  void beginAt(const std::string& certificate);
  struct Comparison {
    std::vector<std::string> disagreements;  // one sentence for each thing that the two say otherwise
    std::vector<std::string> remarks;        // of the certificate, else of the bytes; and the same of remarked topics
  };
  /// What this certificate says, held against certificate().
  [[nodiscard]] Comparison compare(const std::string& certificate) const;
  /// A row of it.
  [[nodiscard]] nlohmann::ordered_json rowOf(const Stream& booked) const;
  [[nodiscard]] const std::map<Key, ReceivedStream>& streams() const { return streams_; }
  [[nodiscard]] const std::vector<Gap>& gaps() const { return gaps_; }
  [[nodiscard]] const std::set<std::string>& leftOut() const { return left_out_; }
  /// How many services have sent a manifest: each once, however many of its processes did.
  [[nodiscard]] std::size_t servicesHeard() const;
  /// Samples that never came, on topics of which none may be missing: not a status, not a request.
  [[nodiscard]] std::uint64_t missing() const;

 private:
  enum class Concern { kVerdict, kRemark };  // what a loss does: it costs the verdict, or is only told

  void read(const std::string& topic, std::span<const std::byte> payload);
  void note(Stream& stream, std::uint64_t first_sequence, std::uint64_t last_sequence, const char* reason);
  [[nodiscard]] bool hasManifestOf(const std::string& service) const;
  [[nodiscard]] std::set<Key> vouchedFor() const;
  [[nodiscard]] std::vector<std::string> unvouched(const std::set<Key>& vouched) const;
  [[nodiscard]] std::vector<std::string> problemsOf(const msg::ServiceManifest& manifest) const;
  void compareRows(const nlohmann::json& certificate, Comparison& comparison) const;
  [[nodiscard]] std::vector<std::string> lossesOf(Concern concern, const std::set<Key>& but) const;
  [[nodiscard]] Concern concernOf(const std::string& topic) const {
    return isRemarked(topic) ? Concern::kRemark : Concern::kVerdict;
  }

  std::set<std::string> services_;
  std::set<std::string> given_up_;
  std::map<Key, ReceivedStream> streams_;
  std::vector<Gap> gaps_;
  std::set<std::string> left_out_;
  std::set<std::pair<std::string, std::string>> unrecordable_;  // topic, sentence
  std::set<std::string> lacks_;
  bool are_foreign_remarked_ = false;
  struct Testimony {
    std::uint64_t count = 0;
    std::uint64_t hash = 0;
    std::uint64_t excused = 0;
  };
  std::map<Key, Testimony> testimonies_;         // of a certificate, on what came and is not in the files
  bool is_excerpt_ = false;                      // nobody in the files says what was sent
  std::vector<msg::ServiceManifest> manifests_;  // one a process: a service that was started again has sent two
};

}  // namespace baton
