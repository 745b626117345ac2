#include "replayer.hpp"

#include <fnmatch.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "dds/interfaces.hpp"
#include "runtime/cell.hpp"
#include "runtime/say.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {

/// A replay that is later than this catches up as fast as it can.
constexpr std::int64_t kBehind_ns = 100'000'000;
/// Looks at the readers come this far apart: they are found by discovery, which takes longer.
constexpr std::int64_t kLook_ns = 20'000'000;
/// Nothing else is begun this close to a message.
constexpr std::int64_t kQuiet_ns = 500'000;
constexpr std::int64_t kLongDue_ns = 400'000'000;
constexpr std::int64_t kForever_ns = 1'000'000'000'000'000'000;

dds::ParticipantOptions participantOptions(const ReplayOptions& options, const dds::RunKey& key) {
  dds::ParticipantOptions place{.domain = options.domain,
                                .partition = options.cell + "/" + options.run,
                                .addresses = dds::addressesOf(options.interfaces, dds::interfaces()),
                                .cell = options.cell,
                                .run = options.run,
                                .service = kReplayerName,
                                .role = dds::Role::kReplayer,
                                .transport = options.transport,
                                .key = key,
                                .strangers = dds::Strangers::kAskFreely};  // a replay is for them
  if (options.partition) place.other_partitions.push_back(*options.partition);
  for (const RunInfo& active : activeRuns()) {
    if (active.domain != options.domain) continue;
    const std::string taken = active.cell + "/" + active.run;
    if (taken == place.partition || fnmatch(options.partition.value_or("").c_str(), taken.c_str(), 0) == 0) {
      throw UnavailableError("run " + active.run + " of cell " + active.cell +
                             " is alive and would hear the replay: choose another --cell, --run or --partition");
    }
  }
  return place;
}

void tellOfTrespass(const dds::GuidPrefix& stranger, dds::Trespass what) {
  if (what != dds::Trespass::kSpeaks) return;
  spdlog::warn("a stranger writes: participant {} has not the replay's key and is not heard", dds::toString(stranger));
}

Playback::Plan planOf(const ReplayOptions& options) {
  Playback::Plan plan{.rate = options.rate, .passes = options.passes, .starts_paused = options.starts_paused};
  // Log times are counts of ns in 64 bits: no gap is longer.
  if (options.longest_gap_s && *options.longest_gap_s < 1e10) {
    plan.longest_gap_ns = static_cast<std::uint64_t>(*options.longest_gap_s * 1e9);
  }
  return plan;
}

/// DDS's threads inherit it, so it comes before them.
const ReplayOptions& scheduled(const ReplayOptions& options) {
  for (const std::string& refusal : applyScheduling(options.scheduling, false)) spdlog::warn("{}", refusal);
  return options;
}

}  // namespace

ExitCode exitCode(const ReplayResult& result) {
  if (result.was_interrupted) return ExitCode::kInterrupted;
  return result.problems.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

Replayer::Replayer(const ReplayOptions& options)
    : options_(scheduled(options)),
      playlist_(options),
      playback_(planOf(options)),
      own_key_(options.domain, options.cell, options.run),
      participant_(participantOptions(options, own_key_.key()), {}, tellOfTrespass),
      admission_(participant_, false, [](const std::string& text) { spdlog::warn("{}", text); }),
      outlet_(participant_, playlist_.endpoints(),
              [this] {
                reportBefore(kForever_ns);
                return !isInterrupted() && !playback_.isStopped() && !sleeper_.rings();
              }),
      remote_(participant_, admission_.filter(dds::topics::kReplayRequest), [this] { sleeper_.ring(); }) {
  for (const auto& [id, reason] : outlet_.refused()) playlist_.leaveOut(id, reason);
  playlist_.rewind();
  fetch();
}

ReplayResult Replayer::run() {
  listenToSignals(sleeper_);
  terminal_.emplace();
  progress_.emplace();
  if (terminal_->hasKeys()) {
    say(stderr, "space: pause, resume   right, left: ahead, back   + -: rate   q: quit   (--help)\n");
  }
  waitForReaders();
  begin_ns_ = steadyNow();
  play();
  result_.elapsed_s = static_cast<double>(steadyNow() - begin_ns_) * 1e-9;
  finish();
  return result_;
}

void Replayer::waitForReaders() {
  Audience audience(options_.wait_for, options_.wait_for_readers);
  while (!mustEnd()) {
    const std::string missing = audience.missing(outlet_.readers(), steadyNow());
    if (missing.empty()) return;
    if (missing != waits_for_) spdlog::info("waiting for {}", missing);
    waits_for_ = missing;
    reportBefore(kForever_ns);
    sleepUntil(steadyNow() + kLook_ns);
    serve();
  }
}

void Replayer::play() {
  phase_ = Phase::kPlaying;
  waits_for_.clear();
  if (next_) playback_.begin(next_->log_time_ns, begin_ns_);
  while (!mustEnd()) {
    serve();
    if (!next_) {
      if (!goOnAtEnd()) return;
      continue;
    }
    const Playback::Due due = playback_.due(next_->log_time_ns);
    const std::int64_t deadline_ns = due.deadline_ns.value_or(kForever_ns);
    reportBefore(deadline_ns);
    if (due.is_held || (due.deadline_ns && deadline_ns > steadyNow())) {
      sleepUntil(deadline_ns);
    } else {
      send(due);
    }
  }
}

/// False when the replay is over.
bool Replayer::goOnAtEnd() {
  switch (playback_.reachEnd()) {
    case Playback::AtEnd::kAgain:
      playlist_.rewind();
      fetch();
      if (next_) playback_.begin(next_->log_time_ns, steadyNow());
      return next_.has_value();  // what can be read of a damaged recording may be nothing
    case Playback::AtEnd::kHold:
      endStep("the recording ends here");
      playback_.pause(steadyNow());
      reportBefore(kForever_ns);
      sleepUntil(kForever_ns);
      return true;
    case Playback::AtEnd::kOver: break;
  }
  return false;
}

void Replayer::fetch() {
  mcap::MessageView message;
  next_ = playlist_.next(message) ? std::optional(message) : std::nullopt;
}

void Replayer::send(const Playback::Due& due) {
  const std::int64_t late_before_ns = due.deadline_ns ? steadyNow() - *due.deadline_ns : 0;
  const bool is_sent = outlet_.write(*next_);
  const std::int64_t now_ns = steadyNow();
  if (due.deadline_ns) noteLateness(now_ns - *due.deadline_ns);
  if (is_sent) ++result_.messages;
  playback_.sent(next_->channel->topic, next_->log_time_ns, now_ns);
  outlet_.spareReaders(!due.deadline_ns || playback_.rate() > 1.0 || late_before_ns > kBehind_ns);
  if (step_ && playback_.stepsLeft() == 0) endStep("");
  fetch();
}

void Replayer::noteLateness(std::int64_t late_ns) {
  result_.lateness_ns.record(late_ns);
  if (static_cast<double>(late_ns) * 1e-3 > options_.overdue_us) ++result_.overdue;
}

/// Or until something happens.
void Replayer::sleepUntil(std::int64_t deadline_ns) {
  const bool reports_before = next_report_ns_ > steadyNow() && deadline_ns - next_report_ns_ > kQuiet_ns;
  sleeper_.sleepUntil(reports_before ? next_report_ns_ : deadline_ns, terminal_->descriptor());
}

/// Reports when it is time to: not right in front of a message, unless there is never another time.
void Replayer::reportBefore(std::int64_t deadline_ns) {
  const std::int64_t now_ns = steadyNow();
  const std::int64_t due_for_ns = now_ns - next_report_ns_;
  if (due_for_ns >= 0 && (deadline_ns - now_ns > kQuiet_ns || due_for_ns > kLongDue_ns)) report();
}

void Replayer::finish() {
  phase_ = Phase::kOver;
  endStep("the replay ends");
  outlet_.waitForAcknowledgments();
  result_.was_interrupted = isInterrupted();
  result_.was_stopped = playback_.isStopped();
  result_.total = playlist_.total();
  result_.passes = playback_.pass();
  result_.writers = outlet_.writers();
  result_.topics = outlet_.topics();
  result_.recorded_s = static_cast<double>(playback_.playedTime()) * 1e-9;
  result_.problems = playlist_.problems();
  for (std::string& problem : outlet_.problems()) result_.problems.push_back(std::move(problem));
  const bool expects_readers = options_.wait_for > 0 || !options_.wait_for_readers.empty();
  auto& told = expects_readers ? result_.problems : result_.notes;
  told.insert(told.end(), outlet_.deaf().begin(), outlet_.deaf().end());
  const double max_late_us = static_cast<double>(result_.lateness_ns.max()) * 1e-3;
  if (options_.max_late_us && max_late_us > *options_.max_late_us) {
    result_.problems.push_back(fmt::format("a message went out {:.1f} us late, where --max-late-us allows {:.1f}",
                                           max_late_us, *options_.max_late_us));
  }
  report();
  remote_.sayGoodbye();
  progress_.reset();
  terminal_.reset();
}

}  // namespace baton
