#include "session.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/text.hpp"
#include "booking.hpp"
#include "dds/codec.hpp"
#include "mcap/lookup.hpp"
#include "run_manifest.hpp"
#include "runtime/cell.hpp"
#include "runtime/recording_parts.hpp"

namespace baton {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kIdle = std::chrono::milliseconds(10);  // how long a sample may wait before it is written
constexpr auto kTend = std::chrono::seconds(1);        // what a killed recorder may take along
constexpr std::size_t kMaxStatusText = 199, kMaxTopicText = 64, kMaxText = 399;
// When the run has ended: for what is still on its way, and for the word of those that are not waited for.
constexpr std::chrono::milliseconds kManifestPatience{5000}, kStragglerPatience{500};

Stream::Role roleOf(const std::string& topic) {
  if (topic == dds::topics::kRewind.name) return Stream::Role::kRewind;
  if (topic == dds::topics::kParameterStatus.name) return Stream::Role::kParameterStatus;
  if (topic == dds::topics::kEvent.name) return Stream::Role::kEvent;
  return Stream::Role::kOther;
}

}  // namespace

RecordingSession::RecordingSession(Service& service, SampleQueue& queue, const TopicReaders& topics)
    : service_(service),
      config_(service.scenario().recording),
      queue_(queue),
      topics_(topics),
      status_out_(service.output(dds::topics::kRecorderStatus, withSupervisor({kPlantName}, service.options()))),
      rewind_ack_out_(service.output(dds::topics::kRewindAck, {kPlantName})),
      reply_out_(service.output(dds::topics::kRecordReply)),
      origin_(originOf(service.options(), service.scenario())),
      control_(config_.ring_steps > 0, config_.starts_stopped),
      credit_(service.scenario()),
      ledger_(servicesBut(kRecorderName, service.scenario())),
      path_(service.options().out),
      room_(config_) {
  ledger_.remarkForeignTopics();
  room_.measure(path_);
  if (control_.isRing()) {
    ring_ = std::make_unique<Ring>(config_.ring_steps, config_.ring_bytes);
  } else if (control_.keeps()) {
    start(path_);
  }
}

void RecordingSession::ask(const msg::RecordRequest& request) {
  const std::lock_guard lock(requests_mutex_);
  requests_.push_back(request);
}

ExitCode RecordingSession::run() {
  SampleQueue::Batch batch;
  publishStatus();
  // What is asked takes effect behind all that came before it: what is asked during a batch, behind the next one.
  std::vector<msg::RecordRequest> requests;
  while (queue_.take(batch, kIdle)) {
    takeBatch(batch);
    for (const msg::RecordRequest& request : requests) reply(request);
    requests = takeRequests();
    acknowledge(batch.entries.empty());
    tend();
    if (isDone()) break;
  }
  has_run_ended_ = true;  // nothing can be asked any more
  closeAll();
  for (const msg::RecordRequest& request : requests) reply(request);
  for (const msg::RecordRequest& request : takeRequests()) reply(request);
  return incomplete_.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

// --- what comes
// -------------------------------------------------------------------------------------------------------

void RecordingSession::takeBatch(const SampleQueue::Batch& batch) {
  for (const SampleQueue::Entry& entry : batch.entries) {
    const auto payload = batch.payload(entry);
    Stream& stream = streamOf(entry.topic, entry.writer);
    // What is not in the account may be here twice.
    if (!(stream.is_booked ? book(ledger_, stream, entry, payload) : entry.has_data)) continue;
    if (stream.credit) credit_.came(*stream.credit, payload);
    if (!stream.is_status && !stream.is_foreign) ++progress_;
    // Also what found no room in the queue, which is booked behind the batch it was dropped from.
    const std::uint64_t lost_before = stream.booked(credit_.elapsedSteps());
    if (stream.is_recorded) keep(stream, entry, payload, lost_before);
    if (stream.role != Stream::Role::kOther) learn(stream, payload);
  }
  for (const SampleQueue::Drop& drop : batch.drops) {
    Stream& stream = streamOf(drop.topic, drop.writer);
    if (stream.is_booked) ledger_.dropped(*stream.received, drop.first_sequence, drop.last_sequence);
    stream.dropped(credit_.elapsedSteps());
  }
}

Stream& RecordingSession::streamOf(std::uint32_t topic, const dds::Guid& writer) {
  const auto [found, is_new] = streams_.try_emplace({topic, writer});
  Stream& stream = found->second;
  if (!is_new) return stream;
  const TopicReaders::Writer facts = topics_.of(topic, writer);
  introduce(stream, streams_.size() - 1, facts, writer, true, ledger_);
  stream.role = roleOf(facts.topic);
  stream.credit = credit_.placeOf(facts.topic);
  stream.is_recorded = facts.is_recorded;
  stream.is_manifest = facts.topic == dds::topics::kServiceManifest.name;
  stream.is_booked = facts.is_recorded || stream.is_manifest || facts.topic == dds::topics::kServiceStatus.name;
  stream.is_status = dds::isStatusTopic(facts.topic);
  if (!facts.is_recorded) ledger_.leaveOut(facts.topic);
  return stream;
}

void RecordingSession::keep(const Stream& stream, const SampleQueue::Entry& entry, std::span<const std::byte> payload,
                            std::uint64_t lost_before) {
  const bool is_in_hole = holes_.isOpen() && !stream.is_manifest;
  if (is_in_hole) holes_.leaveOut();
  if (ring_) {
    if (is_in_hole && stream.latched == 0) return;
    ring_->push({.stream = stream.index,
                 .sequence = entry.sequence,
                 .log_time_ns = entry.log_time_ns,
                 .source_timestamp_ns = entry.source_timestamp_ns,
                 .step = credit_.elapsedSteps(),
                 .lost_before = lost_before,
                 .latched = stream.latched,
                 .facts = stream.facts,
                 .is_left_out = is_in_hole,
                 .payload = payload});
    return;
  }
  if (!is_in_hole) write(stream, entry, payload, lost_before);
  // For the files that begin later.
  latched_.keep(stream.index, "", stream.latched,
                {.stream = &stream, .sequence = entry.sequence, .source_timestamp_ns = entry.source_timestamp_ns},
                payload, stream.facts);
  if (latched_.givenUp() > 0 && !std::exchange(told_given_up_, true)) {
    service_.event(msg::SEVERITY_WARNING, "record", kForeignGivenUp);
  }
}

void RecordingSession::write(const Stream& stream, const SampleQueue::Entry& entry, std::span<const std::byte> payload,
                             std::uint64_t lost_before) {
  if (room_.isLimited()) makeRoom();
  try {
    if (recording_) {
      recording_->write(stream, {.sequence = entry.sequence,
                                 .log_time_ns = entry.log_time_ns,
                                 .source_timestamp_ns = entry.source_timestamp_ns,
                                 .lost_before = lost_before,
                                 .payload = payload});
    }
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void RecordingSession::learn(const Stream& stream, std::span<const std::byte> payload) {
  const auto with = [&](auto message, const auto& use) {
    if (dds::decode(payload, message)) use(message);
  };
  switch (stream.role) {
    case Stream::Role::kRewind: return with(msg::Rewind{}, [&](const auto& rewind) { credit_.rewound(rewind); });
    case Stream::Role::kParameterStatus:
      return with(msg::ParameterStatus{}, [&](const auto& status) { notes_.add(status); });
    case Stream::Role::kEvent: return with(msg::Event{}, [&](const auto& event) { notes_.add(event); });
    case Stream::Role::kOther: return;
  }
}

// --- what is asked
// ----------------------------------------------------------------------------------------------------

std::vector<msg::RecordRequest> RecordingSession::takeRequests() {
  const std::lock_guard lock(requests_mutex_);
  return std::exchange(requests_, {});
}

void RecordingSession::reply(const msg::RecordRequest& request) {
  msg::RecordReply reply = answer(request);
  reply.request_id(request.request_id());
  reply.state(control_.state());
  reply.step(credit_.stateStep());
  publishStatus();
  const std::lock_guard lock(service_.mutex());
  reply_out_.write(reply);
}

msg::RecordReply RecordingSession::answer(const msg::RecordRequest& request) {
  msg::RecordReply reply;
  std::string text = control_.objection(request.action());
  if (text.empty() && has_run_ended_) text = "the run is over";
  if (text.empty()) text = objectionTo(request);
  if (!text.empty()) {
    reply.text(text);
    return reply;
  }
  std::string path = path_;
  try {
    switch (request.action()) {
      case msg::RECORD_START:
        path = request.path().size() > 0 ? pathOf(request) : service_.options().out;
        start(path);
        break;
      case msg::RECORD_STOP: text = text_ = finish({.run_is_over = false, .reason = "stopped on request"}); break;
      case msg::RECORD_PAUSE: holes_.open(credit_.take(), credit_.stateStep() + 1, "paused"); break;
      case msg::RECORD_RESUME: holes_.close(credit_.stateStep()); break;
      case msg::RECORD_SNAPSHOT:
        path = pathOf(request);
        text = writeRing(path, {.run_is_over = false, .reason = "the latest of a ring"});
        break;
    }
    control_.done(request.action());
    reply.accepted(true);
  } catch (const std::exception& error) {
    text = error.what();
    if (request.action() == msg::RECORD_STOP) fail(text);
  }
  reply.path(path);
  reply.text(text.substr(0, kMaxText));
  return reply;
}

/// Names come from anybody who may operate the run. A file that is there is never replaced.
std::string RecordingSession::objectionTo(const msg::RecordRequest& request) const {
  if (const std::string name = request.path().c_str(); !name.empty() && !isFileName(name, ".mcap")) {
    return "expected the name of a file that ends in .mcap, without a folder: it lies where the run's recording does; "
           "found " +
           escaped(name);
  }
  if (request.action() != msg::RECORD_SNAPSHOT) return "";
  const std::filesystem::path path = pathOf(request);
  if (path == path_) return path.string() + " is where the ring goes at the end of the run";
  Room there(config_);
  there.measure(path);
  std::uint64_t declared_bytes = 0;
  for (const auto& [key, stream] : streams_) declared_bytes += stream.declaredBytes();
  return roomObjection(config_, ring_->bytes(), declared_bytes, there.freeBytes());
}

void RecordingSession::start(const std::string& path) {
  if (config_.isSplit()) {
    if (const auto others = furtherPartsOf(path); !others.empty()) {
      throw UnavailableError(others.front().string() + " is there already, and would be a part of it");
    }
  }
  recording_ =
      std::make_unique<Recording>(path, config_, origin_, credit_.elapsedSteps(), credit_.stateStep(), &latched_);
  holes_.clear();
  begun_at_ = credit_.elapsedSteps();
  path_ = path;
  room_.measure(path_);
  text_.clear();
}

std::string RecordingSession::pathOf(const msg::RecordRequest& request) const {
  const std::filesystem::path own(service_.options().out);
  if (request.path().size() > 0) {
    return placeOf(service_.options().key_file, own.parent_path(), request.path().c_str()).string();
  }
  const std::string name =
      own.stem().string() + "_step" + std::to_string(credit_.stateStep()) + own.extension().string();
  return (own.parent_path() / name).string();
}

// --- what is done now and then
// ----------------------------------------------------------------------------------------

void RecordingSession::acknowledge(bool is_idle) {
  service_.at(credit_.acknowledged());
  if (credit_.isDue(is_idle)) {
    credit_.told();
    publishStatus();
  }
  if (const std::optional<msg::RewindAck> ack = credit_.answer()) rewind_ack_out_.write(*ack);
}

void RecordingSession::tend() {
  const Clock::time_point now = Clock::now();
  const bool is_tended = now - tended_ < kTend;
  const bool is_synced = config_.sync_s <= 0.0 || now - synced_ < std::chrono::duration<double>(config_.sync_s);
  if (is_tended && is_synced) return;
  try {
    if (recording_ && !is_synced) {
      recording_->sync();
    } else if (recording_) {
      recording_->flush();
    }
  } catch (const std::exception& error) {
    fail(error.what());
  }
  if (!is_synced) synced_ = Clock::now();
  if (is_tended) return;
  tended_ = now;
  room_.measure(path_);
  publishStatus();
}

/// As long as something comes, more may.
bool RecordingSession::isDone() {
  if (!has_run_ended_) return false;
  for (const std::string& topic : topics_.leftOut()) ledger_.leaveOut(topic);
  if (progress_at_end_ != progress_) moved_ = Clock::now();
  progress_at_end_ = progress_;
  const bool is_settled = ledger_.isSettled();
  if (is_settled && ledger_.isVouchedFor()) return true;
  return Clock::now() - moved_ > (is_settled ? kStragglerPatience : kManifestPatience);
}

void RecordingSession::publishStatus() {
  msg::RecorderStatus status;
  status.state(control_.state());
  status.ring(ring_ != nullptr);
  status.take(credit_.take());
  status.acknowledged_step(credit_.acknowledged());
  status.messages(recording_ ? recording_->writtenMessages() : ring_ ? ring_->samples() : finished_messages_);
  status.bytes(recording_ ? recording_->bytes() : ring_ ? ring_->bytes() : finished_bytes_);
  status.part(recording_ ? recording_->part() : 0);
  const SampleQueue::Depth depth = queue_.depth();
  status.queued(depth.samples);
  status.queued_bytes(depth.bytes);
  status.disk_left(room_.freeBytes());
  status.lost(ledger_.missing());
  addLosses(status);
  status.complete(control_.state() == msg::RECORDER_CLOSED && incomplete_.empty());
  status.path(path_);
  status.text(text_.substr(0, kMaxStatusText));
  status_out_.write(status);
}

/// Those of the run's topics first, and of these the largest.
void RecordingSession::addLosses(msg::RecorderStatus& status) const {
  for (const auto& [key, stream] : streams_) {
    if (stream.received->second.missing == 0 || stream.is_status) continue;
    msg::WriterLoss loss;
    loss.topic(stream.topic().substr(0, kMaxTopicText));
    loss.service(mcap::valueOf(stream.metadata, "service"));
    loss.lost(stream.received->second.missing);
    status.losses().push_back(loss);
  }
  std::sort(status.losses().begin(), status.losses().end(), [](const msg::WriterLoss& a, const msg::WriterLoss& b) {
    const bool is_a_foreign = dds::isForeignTopic(a.topic().c_str());
    const bool is_b_foreign = dds::isForeignTopic(b.topic().c_str());
    return std::pair(is_b_foreign, a.lost()) > std::pair(is_a_foreign, b.lost());
  });
  if (status.losses().size() > msg::MAX_LOSSES) status.losses().resize(msg::MAX_LOSSES);
}

}  // namespace baton
