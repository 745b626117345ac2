// Files that grow, and how they end.
#include <spdlog/spdlog.h>

#include <filesystem>
#include <utility>

#include "session.hpp"

namespace baton {

/// Before a sample is written: in this part, in another one, or no more.
void RecordingSession::makeRoom() {
  if (!recording_) return;
  try {
    const Room::Outcome outcome = room_.makeFor(*recording_, credit_.elapsedSteps(), credit_.stateStep());
    if (outcome.has_dropped) path_ = recording_->firstPart().string();
    if (outcome.end.empty()) return;
    text_ = finish({.run_is_over = false, .is_wanted = false, .reason = "ended early: " + outcome.end});
    control_.ended();
    service_.event(
        msg::SEVERITY_WARNING, "record",
        "the recording ends at step " + std::to_string(credit_.stateStep()) + ": " + outcome.end + "; the run goes on");
    publishStatus();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

namespace {

/// Counts what a recording has come to, however it ends.
struct Tally {
  const Recording& recording;
  std::uint64_t& messages;
  std::uint64_t& bytes;
  ~Tally() {
    messages = recording.writtenMessages();
    bytes = recording.bytes();
  }
};

}  // namespace

/// Returns what the certificate says.
std::string RecordingSession::finish(const Ending& ending) {
  // Whatever happens here, it is over.
  const std::unique_ptr<Recording> recording = std::move(recording_);
  const Tally tally{*recording, finished_messages_, finished_bytes_};
  std::string summary = close(*recording, begun_at_, ending, holes_.between(0, credit_.stateStep()));
  holes_.clear();
  return summary;
}

std::string RecordingSession::close(Recording& recording, std::uint64_t begun_at, const Ending& ending,
                                    const std::vector<Hole>& holes) {
  for (const std::string& topic : topics_.leftOut()) ledger_.leaveOut(topic);
  for (const auto& [topic, text] : topics_.unreadable()) ledger_.cannotRecord(topic, text);
  for (const auto& [key, stream] : streams_) {
    stream.received->second.excused = stream.excusedIn(begun_at, recording.missing(stream));
  }
  Certificate certificate(ledger_, ending);
  certificate.setUnmatched(topics_.unmatched());
  for (const auto& [key, stream] : streams_) {
    if (stream.is_recorded && !recording.holds(stream)) certificate.add(stream, {});
  }
  recording.finish(certificate, credit_.stateStep(), holes,
                   {{"parameters.json", "application/json", notes_.parameters()},
                    {"events.json", "application/json", notes_.events()}});
  if (!certificate.isComplete() && incomplete_.empty()) incomplete_ = recording.firstPart().string();
  spdlog::info("closed path={} parts={} messages={} bytes={} {}", recording.path().string(), recording.part() + 1,
               recording.messages(), recording.bytes(), certificate.summary());
  for (const std::string& problem : certificate.problems()) spdlog::warn("incomplete: {}", problem);
  for (const std::string& remark : ledger_.remarks()) spdlog::info("not of the run: {}", remark);
  for (const std::string& pattern : topics_.unmatched()) {
    spdlog::warn("recording: topics or except: expected a pattern that matches a topic, found {}", pattern);
  }
  return certificate.summary();
}

/// All that the ring holds, as a recording of its own.
std::string RecordingSession::writeRing(const std::string& path, const Ending& ending) {
  const std::uint64_t span = credit_.elapsedSteps() - ring_->firstStep().value_or(credit_.elapsedSteps());
  const std::uint64_t from_step = credit_.stateStep() - std::min(span, credit_.stateStep());
  std::vector<const Stream*> streams(streams_.size());
  for (const auto& [key, stream] : streams_) streams[stream.index] = &stream;
  Latched older(std::numeric_limits<std::size_t>::max());
  ring_->older().forEach([&](const auto& sample) {
    const Ring::Sample& head = sample.head;
    older.keep(
        head.stream, "", head.latched,
        {.stream = streams[head.stream], .sequence = head.sequence, .source_timestamp_ns = head.source_timestamp_ns},
        sample.bytes);
  });
  Recording recording(path, config_, origin_, credit_.elapsedSteps(), from_step, &older);
  const Tally tally{recording, finished_messages_, finished_bytes_};
  ring_->forEach([&](const Ring::Sample& sample) {
    recording.write(*streams[sample.stream], {.sequence = sample.sequence,
                                              .log_time_ns = sample.log_time_ns,
                                              .source_timestamp_ns = sample.source_timestamp_ns,
                                              .lost_before = sample.lost_before,
                                              .payload = sample.payload});
  });
  return close(recording, ring_->firstStep().value_or(0), ending, holes_.between(from_step, credit_.stateStep()));
}

/// Nothing more is written; what comes is taken all the same, so that the run goes on.
void RecordingSession::fail(const std::string& what) {
  spdlog::error("recording failed: {}", what);
  text_ = "recording failed: " + what;
  try {
    if (recording_) (void)finish({.run_is_over = false, .is_wanted = false, .reason = "ended early: " + what});
  } catch (const std::exception&) {
    // What is in the file up to here stays readable.
  }
  ring_.reset();
  if (incomplete_.empty()) incomplete_ = path_;
  control_.failed();
  publishStatus();
  service_.event(msg::SEVERITY_ERROR, "record", text_ + "; the run goes on");
}

void RecordingSession::closeAll() {
  try {
    if (ring_) {
      text_ = writeRing(path_, {.reason = "the latest of a ring"});
      ring_.reset();
    } else if (recording_) {
      text_ = finish({});
    } else if (text_.empty()) {
      text_ = "nothing was recorded: `baton record start` begins a recording while the run goes on";
    }
    // The verdict is on all that the run has recorded, not on the latest file alone.
    if (!incomplete_.empty() && incomplete_ != path_) {
      const std::string name = std::filesystem::path(incomplete_).filename().string();
      text_ = "incomplete: " + name + ", an earlier recording of this run; the latest: " + text_;
    }
    control_.closed();
  } catch (const std::exception& error) {
    fail(error.what());
  }
  publishStatus();
  status_out_.raw().waitForAcknowledgments(1000);
}

}  // namespace baton
