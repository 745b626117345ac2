// What operators and keys ask of a replay, and what it tells of itself.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "control/nearest_name.hpp"
#include "replayer.hpp"

namespace baton {
namespace {

constexpr std::int64_t kReportPeriod_ns = 100'000'000;
constexpr std::int64_t kQuietStart_ns = 2'000'000'000;  // a replay shorter than this needs no progress line
constexpr std::uint64_t kKeyJump_ns = 1'000'000'000;
constexpr double kSlowest = 1.0 / 64.0;  // by keys
constexpr double kFastest = 64.0;

}  // namespace

void Replayer::serve() {
  if (sleeper_.wasRung()) {
    for (const msg::ReplayRequest& request : remote_.take()) obey(request);
  }
  for (const Key key : terminal_->keys()) obey(key);
}

/// Steps may be counted by any topic that is replayed.
std::string Replayer::objectionTo(const std::string& topic) const {
  const std::vector<std::string> known = playlist_.topics();
  if (topic.empty() || std::ranges::binary_search(known, topic)) return "";
  return "expected a topic that is replayed, found " + topic + didYouMean(topic, known);
}

/// Empty when it can be done.
std::string Replayer::refusalOf(const msg::ReplayRequest& request) const {
  switch (request.action()) {
    case msg::REPLAY_STEP:
      if (phase_ == Phase::kWaiting) return "it waits for " + (waits_for_.empty() ? "its readers" : waits_for_);
      if (request.messages() == 0) return "expected at least one message";
      return objectionTo(request.topic().c_str());
    case msg::REPLAY_SEEK: {
      const std::int64_t from_ns = static_cast<std::int64_t>(playlist_.firstPosition());
      const std::int64_t to_ns = static_cast<std::int64_t>(playlist_.lastPosition());
      if (request.position_ns() >= from_ns && request.position_ns() <= to_ns) return "";
      return fmt::format("expected {:.9g} to {:.9g} s, found {:.9g}", static_cast<double>(from_ns) * 1e-9,
                         static_cast<double>(to_ns) * 1e-9, static_cast<double>(request.position_ns()) * 1e-9);
    }
    case msg::REPLAY_RATE:
      if (std::isfinite(request.rate()) && request.rate() >= 0.0) return "";
      return "expected a positive rate, or 0 for as fast as possible";
    case msg::REPLAY_PAUSE:
    case msg::REPLAY_RESUME:
    case msg::REPLAY_STOP: return "";
  }
  return "expected pause, resume, step, seek, rate or stop";
}

void Replayer::obey(const msg::ReplayRequest& request) {
  if (const std::string refusal = refusalOf(request); !refusal.empty()) return answer(request.request_id(), refusal);
  const std::int64_t now_ns = steadyNow();
  if (request.action() != msg::REPLAY_RATE) endStep("something else was asked for");
  next_report_ns_ = now_ns;
  switch (request.action()) {
    case msg::REPLAY_PAUSE: playback_.pause(now_ns); break;
    case msg::REPLAY_RESUME: playback_.resume(now_ns); break;
    case msg::REPLAY_STEP:
      playback_.step(request.messages(), request.topic().c_str(), now_ns);
      step_ = request;
      return;  // answered when it is done
    case msg::REPLAY_SEEK: seek(static_cast<std::uint64_t>(request.position_ns())); break;
    case msg::REPLAY_RATE: playback_.setRate(request.rate(), now_ns); break;
    case msg::REPLAY_STOP: playback_.stop(); break;
  }
  answer(request.request_id(), "");
}

void Replayer::seek(std::uint64_t position_ns) {
  const std::uint64_t log_time_ns = playlist_.startTime() + position_ns;
  playlist_.seek(log_time_ns);
  fetch();
  playback_.seek(log_time_ns, steadyNow());
}

/// @param why_short  empty for a step that is done.
void Replayer::endStep(const std::string& why_short) {
  if (!step_) return;
  const msg::ReplayRequest request = *step_;
  step_.reset();
  const std::uint64_t left = playback_.stepsLeft();
  const std::string refusal = why_short.empty() ? ""
                                                : fmt::format("{}: {} of {} were sent", why_short,
                                                              request.messages() - left, request.messages());
  answer(request.request_id(), refusal);
}

/// Keys are not answered.
void Replayer::answer(std::uint64_t request_id, const std::string& refusal) {
  if (request_id == 0) return;
  msg::ReplayReply reply;
  reply.request_id(request_id);
  reply.accepted(refusal.empty());
  reply.messages(result_.messages);
  reply.position_ns(static_cast<std::int64_t>(position()));
  reply.reason(refusal);
  remote_.answer(reply);
}

void Replayer::obey(Key key) {
  msg::ReplayRequest request;
  const double rate = playback_.rate();
  const auto jumpTo = [&](std::uint64_t position_ns) {
    request.action(msg::REPLAY_SEEK);
    request.position_ns(
        static_cast<std::int64_t>(std::clamp(position_ns, playlist_.firstPosition(), playlist_.lastPosition())));
  };
  switch (key) {
    case Key::kSpace: request.action(playback_.isPlaying() ? msg::REPLAY_PAUSE : msg::REPLAY_RESUME); break;
    case Key::kRight:
      request.action(msg::REPLAY_STEP);
      // Of keys struck faster than messages go out, each counts.
      request.messages(step_ && step_->request_id() == 0 ? playback_.stepsLeft() + 1 : 1);
      if (playback_.isPlaying()) jumpTo(position() + kKeyJump_ns);
      break;
    case Key::kLeft: jumpTo(position() - std::min(position(), kKeyJump_ns)); break;
    case Key::kPlus:
      request.action(msg::REPLAY_RATE);
      request.rate(rate > 0.0 ? std::min(rate * 2.0, std::max(rate, kFastest)) : rate);
      break;
    case Key::kMinus:
      request.action(msg::REPLAY_RATE);
      request.rate(rate > 0.0 ? std::max(rate * 0.5, std::min(rate, kSlowest)) : 1.0);
      break;
    case Key::kQuit: request.action(msg::REPLAY_STOP); break;
  }
  obey(request);
}

msg::ReplayState Replayer::state() const {
  switch (phase_) {
    case Phase::kWaiting: return msg::REPLAY_WAITING;
    case Phase::kOver: return msg::REPLAY_FINISHED;
    case Phase::kPlaying: break;
  }
  return playback_.isPlaying() ? msg::REPLAY_PLAYING : msg::REPLAY_PAUSED;
}

std::uint64_t Replayer::position() const {
  const std::uint64_t log_time_ns = playback_.position(steadyNow());
  return log_time_ns > playlist_.startTime() ? log_time_ns - playlist_.startTime() : 0;
}

void Replayer::report() {
  next_report_ns_ = steadyNow() + kReportPeriod_ns;
  const auto lateness_us = [&](double p) { return static_cast<double>(result_.lateness_ns.quantile(p)) * 1e-3; };
  msg::ReplayStatus status;
  status.state(state());
  status.messages(result_.messages);
  status.total(playlist_.total());
  status.pass(playback_.pass());
  status.passes(playback_.passes());
  status.rate(playback_.rate());
  status.position_ns(static_cast<std::int64_t>(position()));
  status.duration_ns(static_cast<std::int64_t>(playlist_.duration()));
  status.lateness_p50_us(lateness_us(0.5));
  status.lateness_p99_us(lateness_us(0.99));
  status.lateness_max_us(lateness_us(1.0));
  status.overdue(result_.overdue);
  status.waiting_for(waits_for_);
  status.path(options_.file);
  remote_.tell(status);
  showProgress(status.state());
}

void Replayer::showProgress(msg::ReplayState state) {
  if (!progress_ || state == msg::REPLAY_FINISHED) return;
  if (!terminal_->hasKeys() && (phase_ != Phase::kPlaying || steadyNow() - begin_ns_ < kQuietStart_ns)) return;
  const double now_s = static_cast<double>(position()) * 1e-9;
  const double end_s = static_cast<double>(playlist_.duration()) * 1e-9;
  std::string text = fmt::format("{} {:.1f} of {:.1f} s, {}", progressBar(end_s > 0.0 ? now_s / end_s : 1.0), now_s,
                                 end_s, playback_.rate() > 0.0 ? fmt::format("x {:g}", playback_.rate()) : "max");
  if (playback_.passes() != 1) text += fmt::format(", pass {}", playback_.pass());
  if (state == msg::REPLAY_PAUSED) text += ", paused";
  if (state == msg::REPLAY_WAITING) text += ", waiting for readers";
  progress_->show(text);
}

}  // namespace baton
