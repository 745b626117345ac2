#include "replayer.hpp"

#include <spdlog/spdlog.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>

#include "control/nearest_name.hpp"
#include "endpoints.hpp"
#include "runtime/cell.hpp"
#include "time/pacer.hpp"

namespace baton {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kReportPeriod = kSecond / 10;
constexpr std::int64_t kQuietStart = 2 * kSecond;  // a replay shorter than this needs no progress line

/// What the kernel counts against a socket's buffer for a small datagram beside its payload.
constexpr std::uint64_t kDatagramBytes = 1280;
/// The receive buffer that Baton's processes ask for, and get where the kernel's limit is not lower.
constexpr std::uint64_t kSocketBuffer = 4 << 20;
constexpr std::int64_t kTellAfter = 5 * kSecond;   // of waiting for a reader to acknowledge
constexpr std::int64_t kDeafAfter = 30 * kSecond;  // longer than discovery takes to notice a death
/// A replay that is later than this catches up as fast as it can.
constexpr std::int64_t kBehind = kSecond / 10;

std::atomic<bool> is_stop_asked{false};

/// The first Ctrl-C ends the replay in order, the second at once.
void listenToSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { is_stop_asked = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::int64_t steadyNow() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

/// How much may be on its way before readers must acknowledge. What overflows a reader's socket is lost, and a reader
/// keeps too few samples to wait long for one to be sent again.
std::uint64_t windowBytes() {
  std::uint64_t limit = 212'992;  // the kernel's own default
  std::ifstream("/proc/sys/net/core/rmem_max") >> limit;
  return std::min(limit, kSocketBuffer);
}

dds::ParticipantOptions participantOptions(const ReplayOptions& options) {
  if (const auto active = activeRun(options.domain, options.cell); active && active->run == options.run) {
    throw UnavailableError("run " + options.run + " of cell " + options.cell +
                           " is alive and would hear the replay: choose another --cell or --run");
  }
  return {.domain = options.domain,
          .partition = options.cell + "/" + options.run,
          .cell = options.cell,
          .run = options.run,
          .service = "replayer",
          .transport = options.transport};
}

std::vector<std::string> topicNames(const mcap::Reader& reader) {
  std::set<std::string> names;
  for (const auto& [id, channel] : reader.channels()) names.insert(channel.topic);
  return {names.begin(), names.end()};
}

}  // namespace

ExitCode exitCode(const ReplayResult& result) {
  if (result.was_interrupted) return ExitCode::kInterrupted;
  return result.problems.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

Replayer::Replayer(const ReplayOptions& options)
    : options_(options),
      reader_(options.file, {.on_damage = [this](const mcap::Damage& damage) { noteDamage(damage); }}),
      participant_(participantOptions(options)),
      status_out_(participant_, dds::topics::kReplayStatus) {
  if (!reader_.info().is_complete) noteProblem("the recording was cut: " + reader_.info().problem);
  checkNames();
  const std::uint64_t start_ns = reader_.statistics().start_time_ns;
  const auto logTimeAt = [&](double seconds) {
    return start_ns + static_cast<std::uint64_t>(std::min(seconds * 1e9, 9e18));
  };
  if (options_.from_s) filter_.start_time_ns = logTimeAt(*options_.from_s);
  if (options_.to_s) filter_.end_time_ns = logTimeAt(*options_.to_s);
  chooseChannels();
  result_.total = countMessages();
  // The count is the file's word: it saves growing, and is not trusted with the memory.
  if (options_.rate > 0.0) lateness_us_.reserve(std::min<std::uint64_t>(result_.total, 1 << 22));
}

void Replayer::noteProblem(const std::string& problem) {
  spdlog::warn("{}", problem);
  result_.problems.push_back(problem);
}

/// Each pass over the file comes across the same damage.
void Replayer::noteDamage(const mcap::Damage& damage) {
  if (!damaged_.insert(damage.offset).second) return;
  noteProblem(std::to_string(damage.length) + " bytes at byte " + std::to_string(damage.offset) +
              " cannot be read: " + damage.reason);
}

void Replayer::checkNames() const {
  const std::vector<std::string> known = topicNames(reader_);
  const auto check = [&](const std::string& topic) {
    if (!std::binary_search(known.begin(), known.end(), topic)) throw UsageError(unknownName("topic", topic, known));
  };
  for (const std::string& topic : options_.topics) check(topic);
  for (const auto& [old_name, new_name] : options_.remap) check(old_name);
}

void Replayer::chooseChannels() {
  std::set<std::string> topics;
  for (const auto& [id, channel] : reader_.channels()) {
    const auto& wanted = options_.topics;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), channel.topic) == wanted.end()) continue;
    const auto schema = reader_.schemas().find(channel.schema_id);
    try {
      const dds::EndpointOptions endpoint =
          replayEndpoint(channel, schema == reader_.schemas().end() ? nullptr : &schema->second, options_.remap);
      writers_.try_emplace(id, participant_, endpoint);
      topics.insert(endpoint.topic);
    } catch (const UsageError& error) {
      noteProblem(error.what());
      continue;
    }
    filter_.channels.push_back(id);
  }
  if (writers_.empty()) throw UsageError(options_.file + ": expected a topic to replay, found none");
  result_.writers = writers_.size();
  result_.topics = topics.size();
}

std::uint64_t Replayer::countMessages() const {
  std::uint64_t count = 0;
  if (options_.from_s || options_.to_s) {
    reader_.forEachMessage(filter_, [&](const mcap::MessageView&) { ++count; });
    return count;
  }
  const auto& counts = reader_.statistics().channel_message_counts;
  for (const mcap::ChannelId id : filter_.channels) {
    if (const auto found = counts.find(id); found != counts.end()) count += found->second;
  }
  return count;
}

ReplayResult Replayer::run() {
  listenToSignals();
  waitForReaders();
  play();
  waitForAcknowledgments();
  result_.was_interrupted = is_stop_asked;
  result_.lateness = latenessOf(lateness_us_);
  reported_ = 0;  // the last status is of all messages
  report(msg::REPLAY_FINISHED);
  status_out_.raw().waitForAcknowledgments(1000);
  if (has_progress_line_) std::fprintf(stderr, "\r\033[K");
  return result_;
}

void Replayer::waitForReaders() {
  std::string told;
  while (!is_stop_asked) {
    std::set<std::string> unread;
    for (const auto& [id, writer] : writers_) {
      if (writer.matched().size() < options_.wait_for) unread.insert(reader_.channels().at(id).topic);
    }
    if (unread.empty()) return;
    std::string missing;
    for (const std::string& topic : unread) missing += (missing.empty() ? "" : ", ") + topic;
    if (missing != told) spdlog::info("waiting for {} reading processes on {}", options_.wait_for, missing);
    told = missing;
    // Matches come from discovery, which takes longer than this.
    if (!sleepUntil(steadyNow() + kSecond / 50)) return;
  }
}

void Replayer::play() {
  mcap::MessageCursor messages = reader_.messages(filter_);
  Pacer pacer(1, options_.rate);  // its steps are nanoseconds of log time
  const std::uint64_t window = windowBytes();
  std::uint64_t in_flight = 0;  // bytes since the last acknowledgment
  state_ = msg::REPLAY_PLAYING;
  begin_ns_ = steadyNow();
  for (mcap::MessageView message; messages.next(message);) {
    if (result_.messages == 0) {
      first_log_time_ns_ = log_time_ns_ = message.log_time_ns;
      begin_ns_ = steadyNow();
      pacer.anchor(first_log_time_ns_, begin_ns_);
    }
    const std::optional<std::int64_t> deadline = pacer.deadline(message.log_time_ns);
    if (!sleepUntil(deadline.value_or(0))) break;
    if (!writers_.at(message.channel->id).write(message.data, static_cast<std::int64_t>(message.publish_time_ns))) {
      throw Error(ExitCode::kFailed, "DDS refused a message of " + std::to_string(message.data.size()) +
                                         " bytes on topic " + message.channel->topic);
    }
    ++result_.messages;
    log_time_ns_ = message.log_time_ns;
    const std::int64_t late_ns = deadline ? steadyNow() - *deadline : 0;
    if (deadline) lateness_us_.push_back(static_cast<double>(late_ns) * 1e-3);
    // At the recorded rate readers keep up as those of the original did, and waiting for them would cost the rhythm.
    const bool is_hurried = !deadline || options_.rate > 1.0 || late_ns > kBehind;
    in_flight = is_hurried ? in_flight + message.data.size() + kDatagramBytes : 0;
    if (in_flight >= window) {
      waitForAcknowledgments();
      in_flight = 0;
    }
  }
  result_.recorded_s = static_cast<double>(log_time_ns_ - first_log_time_ns_) * 1e-9;
  result_.elapsed_s = static_cast<double>(steadyNow() - begin_ns_) * 1e-9;
}

/// Returns false when asked to stop. A deadline that has passed costs a look at the clock.
bool Replayer::sleepUntil(std::int64_t deadline_ns) {
  while (!is_stop_asked) {
    reportWhenDue();
    if (steadyNow() >= deadline_ns) return true;
    const std::int64_t until_ns = std::min(deadline_ns, next_report_ns_);
    const timespec until{.tv_sec = until_ns / kSecond, .tv_nsec = until_ns % kSecond};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
  }
  return false;
}

/// A reader that was killed is waited for until discovery gives it up; one that lives and does not acknowledge, not for
/// ever.
void Replayer::waitForAcknowledgments() {
  for (auto& [id, writer] : writers_) {
    const std::string& topic = reader_.channels().at(id).topic;
    const std::int64_t since_ns = steadyNow();
    bool has_told = false;
    while (!is_stop_asked && !deaf_.contains(id) && !writer.waitForAcknowledgments(100)) {
      reportWhenDue();
      const std::int64_t waited_ns = steadyNow() - since_ns;
      if (waited_ns > kDeafAfter) {
        noteProblem("a reader of " + topic + " does not acknowledge: it is no longer waited for");
        deaf_.insert(id);
      } else if (waited_ns > kTellAfter && !has_told) {
        has_told = true;
        spdlog::info("waiting for a reader of {} to acknowledge", topic);
      }
    }
  }
}

void Replayer::reportWhenDue() {
  if (steadyNow() >= next_report_ns_) report(state_);
}

void Replayer::report(msg::ReplayState state) {
  const std::int64_t now_ns = steadyNow();
  next_report_ns_ = now_ns + kReportPeriod;
  const Lateness lateness = latenessOf(std::span(lateness_us_).subspan(reported_));
  reported_ = lateness_us_.size();
  const mcap::Statistics& statistics = reader_.statistics();
  const std::uint64_t position_ns =
      log_time_ns_ > statistics.start_time_ns ? log_time_ns_ - statistics.start_time_ns : 0;
  const std::uint64_t duration_ns =
      std::max(statistics.end_time_ns, statistics.start_time_ns) - statistics.start_time_ns;
  msg::ReplayStatus status;
  status.state(state);
  status.messages(result_.messages);
  status.total(result_.total);
  status.position_ns(static_cast<std::int64_t>(position_ns));
  status.duration_ns(static_cast<std::int64_t>(duration_ns));
  status.lateness_p50_us(lateness.p50_us);
  status.lateness_p99_us(lateness.p99_us);
  status.lateness_max_us(lateness.max_us);
  status.path(options_.file);
  status_out_.write(status);

  static const bool is_terminal = isatty(STDERR_FILENO) != 0;
  if (!is_terminal || state != msg::REPLAY_PLAYING || now_ns - begin_ns_ < kQuietStart) return;
  has_progress_line_ = true;
  std::fprintf(stderr, "\r\033[K%.1f of %.1f s, %llu of %llu messages", static_cast<double>(position_ns) * 1e-9,
               static_cast<double>(duration_ns) * 1e-9, static_cast<unsigned long long>(result_.messages),
               static_cast<unsigned long long>(result_.total));
}

}  // namespace baton
