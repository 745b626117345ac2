#include "dds/endpoint.hpp"

#include <algorithm>
#include <atomic>
#include <vector>

#include "base/error.hpp"
#include "dds/fastdds.hpp"
#include "dds/participant_impl.hpp"
#include "dds/qos.hpp"
#include "dds/raw_type.hpp"

namespace baton::dds {
namespace {
using namespace fastdds::dds;
namespace rtps = fastdds::rtps;

/// Which participants an endpoint is matched with; several endpoints of one participant count once.
class Matches {
 public:
  void change(const InstanceHandle_t& handle, int delta) {
    rtps::GUID_t guid;
    rtps::iHandle2GUID(guid, handle);
    const std::lock_guard lock(mutex_);
    const GuidPrefix prefix = prefixOf(toGuid(guid));
    if ((counts_[prefix] += delta) <= 0) counts_.erase(prefix);
  }
  [[nodiscard]] std::set<GuidPrefix> prefixes() const {
    const std::lock_guard lock(mutex_);
    std::set<GuidPrefix> result;
    for (const auto& [prefix, count] : counts_) result.insert(prefix);
    return result;
  }

 private:
  mutable std::mutex mutex_;
  std::map<GuidPrefix, int> counts_;
};

[[noreturn]] void refuse(const char* what, const EndpointOptions& options) {
  throw UnavailableError(std::string("DDS could not create a ") + what + " on topic " + options.topic + " of type " +
                         options.type);
}

template <class Qos>
void applyOptions(const EndpointOptions& options, Qos& qos) {
  applyProfile(options.profile, qos);
  if (options.best_effort) qos.reliability().kind = BEST_EFFORT_RELIABILITY_QOS;
  qos.ownership().kind = options.exclusive_ownership ? EXCLUSIVE_OWNERSHIP_QOS : SHARED_OWNERSHIP_QOS;
  if (options.keyed) {
    // As many instances as come; the default of 10 would fail silently beyond that.
    qos.resource_limits().max_instances = 0;
    qos.resource_limits().max_samples = 0;
    qos.resource_limits().max_samples_per_instance = qos.history().depth;
  }
}

/// For ever, too, when it is longer than DDS can say.
fastdds::Duration_t durationOf(std::int64_t duration_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t seconds = duration_ns / kSecond_ns;
  if (duration_ns <= 0 || seconds >= fastdds::kInfiniteSeconds) return fastdds::kForever;
  return {static_cast<std::int32_t>(seconds), static_cast<std::uint32_t>(duration_ns % kSecond_ns)};
}

void applyPromises(const EndpointOptions& options, DataWriterQos& qos) {
  qos.deadline().period = durationOf(options.deadline_ns);
  qos.ownership_strength().value = options.ownership_strength;
  switch (options.liveliness.kind) {
    case Liveliness::Kind::kAutomatic: qos.liveliness().kind = AUTOMATIC_LIVELINESS_QOS; break;
    case Liveliness::Kind::kManualByParticipant: qos.liveliness().kind = MANUAL_BY_PARTICIPANT_LIVELINESS_QOS; break;
    case Liveliness::Kind::kManualByTopic: qos.liveliness().kind = MANUAL_BY_TOPIC_LIVELINESS_QOS; break;
  }
  qos.liveliness().lease_duration = durationOf(options.liveliness.lease_ns);
  qos.liveliness().announcement_period = durationOf(options.liveliness.lease_ns / 2);  // must be shorter than the lease
}
}  // namespace

struct RawWriter::Impl final : DataWriterListener {
  Impl(Participant& participant_in, const EndpointOptions& options, MatchCallback on_match_in)
      : participant(participant_in), on_match(std::move(on_match_in)) {
    Participant::Impl& shared = participant.impl();
    Topic* topic = shared.topic(options.topic, options.type, options.max_payload, options.keyed);
    DataWriterQos qos = shared.publisher->get_default_datawriter_qos();
    applyOptions(options, qos);
    applyPromises(options, qos);
    writer = shared.publisher->create_datawriter(topic, qos, this, StatusMask::publication_matched());
    if (writer == nullptr) refuse("writer", options);
  }
  ~Impl() override {
    writer->set_listener(nullptr);
    // While Fast DDS 2.9.1 deletes a writer that holds samples, a heartbeat that looks at them may never end.
    std::size_t removed = 0;
    writer->clear_history(&removed);
    participant.impl().publisher->delete_datawriter(writer);
  }

  void on_publication_matched(DataWriter*, const PublicationMatchedStatus& status) override {
    matches.change(status.last_subscription_handle, status.current_count_change);
    if (on_match) on_match();
  }

  bool write(std::span<const std::byte> payload, rtps::WriteParams& params) noexcept {
    RawType::Outgoing outgoing{payload};
    if (!fastdds::isDone(writer->write(&outgoing, params))) return false;
    ++count;
    return true;
  }

  Participant& participant;
  MatchCallback on_match;
  Matches matches;
  DataWriter* writer = nullptr;
  std::atomic<std::uint64_t> count{0};
};

RawWriter::RawWriter(Participant& participant, const EndpointOptions& options, MatchCallback on_match)
    : impl_(std::make_unique<Impl>(participant, options, std::move(on_match))) {}
RawWriter::~RawWriter() = default;

bool RawWriter::write(std::span<const std::byte> payload) noexcept {
  return write(payload, impl_->participant.impl().clock.now());
}

bool RawWriter::write(std::span<const std::byte> payload, std::int64_t source_timestamp_ns) noexcept {
  rtps::WriteParams params;
  params.source_timestamp().from_ns(source_timestamp_ns);
  return impl_->write(payload, params);
}

std::set<GuidPrefix> RawWriter::matched() const { return impl_->matches.prefixes(); }
Guid RawWriter::guid() const { return toGuid(impl_->writer->guid()); }
std::uint64_t RawWriter::count() const { return impl_->count; }

bool RawWriter::waitForAcknowledgments(int timeout_ms) {
  const fastdds::Duration_t timeout(timeout_ms / 1000, static_cast<std::uint32_t>(timeout_ms % 1000) * 1'000'000U);
  return fastdds::isDone(impl_->writer->wait_for_acknowledgments(timeout));
}

struct RawReader::Impl final : DataReaderListener {
  Impl(Participant& participant_in, const EndpointOptions& options, Callback callback_in, MatchCallback on_match_in,
       WriterFilter filter_in)
      : participant(participant_in),
        callback(std::move(callback_in)),
        on_match(std::move(on_match_in)),
        filter(std::move(filter_in)) {
    incoming.payload.reserve(options.max_payload);
    is_keyed = options.keyed;
    Participant::Impl& shared = participant.impl();
    Topic* topic = shared.topic(options.topic, options.type, options.max_payload, options.keyed);
    DataReaderQos qos = shared.subscriber->get_default_datareader_qos();
    applyOptions(options, qos);
    // The hash of the key, which only the owner of an instance needs: Cyclone DDS matches no reader that asks for it.
    qos.expects_inline_qos(options.keyed && options.exclusive_ownership);
    if (options.any_encoding) fastdds::acceptAnyEncoding(qos);
    reader = shared.subscriber->create_datareader(
        topic, qos, this,
        StatusMask::data_available() << StatusMask::subscription_matched() << StatusMask::sample_lost());
    if (reader == nullptr) refuse("reader", options);
  }
  ~Impl() override {
    reader->set_listener(nullptr);
    participant.impl().subscriber->delete_datareader(reader);
  }

  void on_data_available(DataReader* source) override {
    SampleInfo info;
    while (fastdds::isDone(source->take_next_sample(&incoming, &info))) {
      if (!info.valid_data && !is_keyed) continue;
      const RawSample sample{.payload = incoming.payload,
                             .sequence = info.sample_identity.sequence_number().to64long(),
                             .source_timestamp_ns = info.source_timestamp.to_ns(),
                             .reception_timestamp_ns = info.reception_timestamp.to_ns(),
                             .writer = toGuid(info.sample_identity.writer_guid()),
                             .has_data = info.valid_data};
      if (filter && !filter(sample.writer)) {
        ++refused;
      } else if (is_keyed) {
        burst.push_back({sample, incoming.payload});
      } else {
        callback(sample);
      }
    }
    if (is_keyed) deliverBurst();
  }
  /// DDS hands out what is there of one instance after the other.
  void deliverBurst() {
    std::stable_sort(burst.begin(), burst.end(), [](const Kept& a, const Kept& b) {
      return a.sample.writer == b.sample.writer ? a.sample.sequence < b.sample.sequence
                                                : a.sample.writer < b.sample.writer;
    });
    for (Kept& one : burst) {
      one.sample.payload = one.payload;
      callback(one.sample);
    }
    burst.clear();
  }
  void on_subscription_matched(DataReader*, const SubscriptionMatchedStatus& status) override {
    matches.change(status.last_publication_handle, status.current_count_change);
    if (on_match) on_match();
  }
  void on_sample_lost(DataReader*, const SampleLostStatus& status) override {
    lost = static_cast<std::uint64_t>(std::max(0, status.total_count));
  }

  Participant& participant;
  Callback callback;
  MatchCallback on_match;
  WriterFilter filter;
  std::atomic<std::uint64_t> refused{0};
  Matches matches;
  RawType::Incoming incoming;  // reused: taking a sample allocates only when one is larger than all before
  bool is_keyed = false;
  struct Kept {
    RawSample sample;
    std::vector<std::byte> payload;
  };
  std::vector<Kept> burst;  // of a keyed topic
  std::atomic<std::uint64_t> lost{0};
  DataReader* reader = nullptr;
};

RawReader::RawReader(Participant& participant, const EndpointOptions& options, Callback callback,
                     MatchCallback on_match, WriterFilter filter)
    : impl_(std::make_unique<Impl>(participant, options, std::move(callback), std::move(on_match), std::move(filter))) {
}
RawReader::~RawReader() = default;
std::set<GuidPrefix> RawReader::matched() const { return impl_->matches.prefixes(); }
std::uint64_t RawReader::refused() const { return impl_->refused; }
std::uint64_t RawReader::lost() const { return impl_->lost; }

}  // namespace baton::dds
