#include "traffic/session.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
#include <set>

#include "base/plural.hpp"
#include "base/text.hpp"
#include "booking.hpp"
#include "mcap/lookup.hpp"
#include "run_manifest.hpp"
#include "runtime/paths.hpp"
#include "runtime/recording_parts.hpp"

namespace baton {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kWriteDelay = std::chrono::milliseconds(20);   // how long a sample may wait before it is written
constexpr auto kFlushPeriod = std::chrono::seconds(1);        // what a killed recorder may take along
constexpr auto kShowPeriod = std::chrono::milliseconds(200);  // between two progress lines
constexpr auto kMatchPatience = std::chrono::seconds(2);
constexpr LimitNames kLimits{.max = "--max-MB", .min_free = "--min-free-MB"};

Origin originOfTraffic(const TrafficOptions& options) {
  mcap::StringMap facts = factsOfProgram();
  const auto list = [](const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ",")); };
  facts.merge(mcap::StringMap{{"kind", "traffic"},
                              {"run", newRunId()},
                              {"domain", std::to_string(options.domain)},
                              {"interfaces", options.interfaces.empty() ? "all" : list(options.interfaces)},
                              {"partitions", options.partitions.empty() ? "all" : list(options.partitions)},
                              {"topics", list(options.selection.topics)},
                              {"except", list(options.selection.except)}});
  return {.run = std::move(facts), .attachments = {}};
}

}  // namespace

TrafficSession::TrafficSession(const TrafficOptions& options, const std::filesystem::path& file, SampleQueue& queue,
                               const TopicReaders& topics)
    : options_(options),
      queue_(queue),
      topics_(topics),
      origin_(originOfTraffic(options)),
      room_(options.recording, kLimits),
      recording_(std::make_unique<Recording>(file, options.recording, origin_, 0, 0, &latched_)) {
  room_.measure(recording_->path());
}

void TrafficSession::end(TrafficEnd how, const std::string& reason) {
  {
    const std::lock_guard lock(end_mutex_);
    if (!end_) end_ = {how, reason};
  }
  queue_.close();
}

bool TrafficSession::isOver() {
  const std::lock_guard lock(end_mutex_);
  return end_.has_value();
}

std::uint64_t TrafficSession::elapsedMilliseconds() const {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begun_).count());
}

TrafficResult TrafficSession::run() {
  SampleQueue::Batch batch;
  while (queue_.take(batch, kWriteDelay)) {
    try {
      takeBatch(batch);
      tend();
    } catch (const std::exception& error) {
      fail(error.what());
    }
  }
  line_.clear();
  finish();
  return std::move(result_);
}

void TrafficSession::fail(const std::string& what) {
  {
    const std::lock_guard lock(end_mutex_);
    end_ = {TrafficEnd::kTooEarly, what};
  }
  queue_.close();
  finish();
}

void TrafficSession::takeBatch(const SampleQueue::Batch& batch) {
  for (const SampleQueue::Entry& entry : batch.entries) {
    const auto payload = batch.payload(entry);
    Stream& stream = streamOf(entry.topic, entry.writer);
    if (!book(ledger_, stream, entry, payload)) continue;
    keep(stream, entry, payload, stream.booked(0));
  }
  for (const SampleQueue::Drop& drop : batch.drops) {
    Stream& stream = streamOf(drop.topic, drop.writer);
    ledger_.dropped(*stream.received, drop.first_sequence, drop.last_sequence);
    stream.dropped(0);
  }
}

Stream& TrafficSession::streamOf(std::uint32_t topic, const dds::Guid& writer) {
  const auto [found, is_new] = streams_.try_emplace({topic, writer});
  Stream& stream = found->second;
  if (!is_new) return stream;
  const TopicReaders::Writer facts = topics_.of(topic, writer);
  introduce(stream, streams_.size() - 1, facts, writer, options_.recording.isSplit(), ledger_);
  line_.clear();
  spdlog::info("recording topic={} type={} writer={}", facts.topic, facts.type, dds::toString(writer));
  return stream;
}

void TrafficSession::keep(const Stream& stream, const SampleQueue::Entry& entry, std::span<const std::byte> payload,
                          std::uint64_t lost_before) {
  if (!recording_) return;
  if (room_.isLimited()) {
    const Room::Outcome outcome = room_.makeFor(*recording_, elapsedMilliseconds(), 0);
    if (!outcome.end.empty()) {
      end(outcome.is_disk_low ? TrafficEnd::kTooEarly : TrafficEnd::kReached, outcome.end);
      return finish();
    }
  }
  recording_->write(stream, {.sequence = entry.sequence,
                             .log_time_ns = entry.log_time_ns,
                             .source_timestamp_ns = entry.source_timestamp_ns,
                             .lost_before = lost_before,
                             .payload = payload});
  // For the parts that begin later.
  latched_.keep(stream.index, "", stream.latched,
                {.stream = &stream, .sequence = entry.sequence, .source_timestamp_ns = entry.source_timestamp_ns},
                payload, stream.facts);
  if (options_.max_messages == 0 || recording_->messages() < options_.max_messages) return;
  end(TrafficEnd::kReached, fmt::format("--max-messages, {}, is reached", options_.max_messages));
  finish();
}

void TrafficSession::tend() {
  const Clock::time_point now = Clock::now();
  if (now - flushed_ >= kFlushPeriod && recording_) {
    recording_->flush();
    flushed_ = now;
  }
  if (now - shown_ < kShowPeriod) return;
  shown_ = now;
  showProgress();
}

void TrafficSession::showProgress() {
  if (!recording_ || isOver()) return;
  std::set<std::string> topics;
  for (const auto& [key, stream] : streams_) topics.insert(stream.topic());
  line_.show(fmt::format("{}: {:.0f} s, {}, {}, {:.2f} MB, {} lost (Ctrl-C ends it)",
                         recording_->path().filename().string(), static_cast<double>(elapsedMilliseconds()) * 1e-3,
                         counted(topics.size(), "topic"), counted(recording_->messages(), "message"),
                         static_cast<double>(recording_->bytes()) * 1e-6, ledger_.missing()));
}

void TrafficSession::noteWhatCannotBeRecorded(const Recording& recording) {
  result_.left_out = topics_.leftOut();
  for (const std::string& topic : result_.left_out) ledger_.leaveOut(topic);
  for (const auto& [topic, text] : topics_.unreadable()) ledger_.cannotRecord(topic, text);
  for (const std::string& what : topics_.unmatchedWriters(kMatchPatience)) ledger_.cannotRecord(what);
  if (recording.messages() > 0) return;
  ledger_.cannotRecord(fmt::format(
      "nothing came: expected writers in domain {} on {}, found {}; check --domain, --interface, --topics and "
      "--partition",
      options_.domain,
      options_.interfaces.empty() ? "any interface" : fmt::format("{}", fmt::join(options_.interfaces, ", ")),
      result_.left_out.empty() ? "none that sent anything" : "only topics that are left out"));
}

/// Once; whatever happens here, the recording is over.
void TrafficSession::finish() {
  if (!recording_) return;
  const std::unique_ptr<Recording> recording = std::move(recording_);
  noteWhatCannotBeRecorded(*recording);
  {
    const std::lock_guard lock(end_mutex_);
    result_.end = end_ ? end_->first : TrafficEnd::kSignal;
    result_.ended = end_ ? end_->second : "ended";
  }
  const bool is_wanted = result_.end != TrafficEnd::kTooEarly;
  Certificate certificate(ledger_, {.run_is_over = false,
                                    .is_wanted = is_wanted,
                                    .reason = (is_wanted ? "as received, " : "ended early: ") + result_.ended});
  certificate.setUnmatched(topics_.unmatched());
  for (const auto& [key, stream] : streams_) {
    if (!recording->holds(stream)) certificate.add(stream, {});
  }
  result_.summary = certificate.summary();
  result_.problems = certificate.problems();
  result_.unmatched = topics_.unmatched();
  try {
    recording->finish(certificate, 0, {}, {});
    result_.is_complete = certificate.isComplete();
  } catch (const std::exception& error) {
    // What is in the file up to here stays readable.
    spdlog::error("{}", error.what());
    result_.end = TrafficEnd::kTooEarly;
    result_.summary = std::string("incomplete: ended early: ") + error.what();
    result_.problems.insert(result_.problems.begin(), std::string("ended early: ") + error.what());
  }
  count(*recording);
}

void TrafficSession::count(const Recording& recording) {
  for (unsigned part = 0; part <= recording.part(); ++part) {
    result_.files.push_back(partOf(recording.path(), part).string());
  }
  result_.seconds = static_cast<double>(elapsedMilliseconds()) * 1e-3;
  result_.messages = recording.writtenMessages();
  result_.bytes = recording.bytes();
  std::map<std::pair<std::string, std::string>, TrafficResult::Topic> topics;
  for (const auto& [key, stream] : streams_) {
    const ReceivedStream& received = stream.received->second;
    TrafficResult::Topic& topic = topics[{stream.topic(), stream.type}];
    topic.messages += received.count;
    topic.lost += received.missing;
    ++topic.writers;
    if (received.missing == 0) continue;
    result_.losses.push_back({.topic = stream.topic(),
                              .writer = dds::toString(stream.writer()),
                              .service = mcap::valueOf(stream.metadata, "service"),
                              .lost = received.missing});
  }
  std::ranges::sort(result_.losses, std::greater<>{}, &TrafficResult::Loss::lost);
  for (auto& [key, topic] : topics) {
    topic.name = key.first;
    topic.type = key.second;
    result_.topics.push_back(std::move(topic));
  }
}

}  // namespace baton
