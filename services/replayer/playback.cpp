#include "playback.hpp"

#include <algorithm>

namespace baton {
namespace {

/// A replay that was held up for longer, by a reader or with its whole process, goes on at its rate from there; a
/// shorter delay is caught up.
constexpr std::int64_t kStall_ns = 1'000'000'000;

}  // namespace

Playback::Playback(const Plan& plan) : plan_(plan), pacer_(1, plan.rate), is_playing_(!plan.starts_paused) {}

void Playback::hold(std::int64_t now_ns) {
  head_ns_ = position(now_ns);
  is_playing_ = false;
  steps_left_ = 0;
}

void Playback::pause(std::int64_t now_ns) { hold(now_ns); }

void Playback::resume(std::int64_t now_ns) {
  hold(now_ns);
  pacer_.anchor(head_ns_, now_ns);
  is_playing_ = true;
}

void Playback::step(std::uint64_t count, const std::string& topic, std::int64_t now_ns) {
  hold(now_ns);
  steps_left_ = count;
  step_topic_ = topic;
}

void Playback::seek(std::uint64_t log_time_ns, std::int64_t now_ns) {
  steps_left_ = 0;
  head_ns_ = next_ns_ = log_time_ns;
  previous_ns_.reset();
  pacer_.anchor(head_ns_, now_ns);
}

void Playback::setRate(double rate, std::int64_t now_ns) {
  head_ns_ = position(now_ns);
  pacer_.setRate(rate, head_ns_, now_ns);
}

void Playback::begin(std::uint64_t first_log_time_ns, std::int64_t now_ns) {
  head_ns_ = next_ns_ = first_log_time_ns;
  previous_ns_.reset();
  pacer_.anchor(head_ns_, now_ns);
}

Playback::Due Playback::due(std::uint64_t log_time_ns) {
  next_ns_ = log_time_ns;
  if (!is_playing_) return {.is_held = steps_left_ == 0, .deadline_ns = std::nullopt};
  const std::uint64_t from_ns = previous_ns_.value_or(head_ns_);  // after a seek: the place sought
  if (log_time_ns - from_ns > plan_.longest_gap_ns) {
    const std::int64_t due_ns = pacer_.deadline(from_ns).value_or(0);
    head_ns_ = log_time_ns - plan_.longest_gap_ns;
    if (previous_ns_) previous_ns_ = head_ns_;
    pacer_.anchor(head_ns_, due_ns);
  }
  return {.is_held = false, .deadline_ns = pacer_.deadline(log_time_ns)};
}

void Playback::sent(const std::string& topic, std::uint64_t log_time_ns, std::int64_t now_ns) {
  if (previous_ns_) played_ns_ += log_time_ns - *previous_ns_;
  previous_ns_ = head_ns_ = log_time_ns;
  if (is_playing_) pacer_.forgive(log_time_ns, now_ns, kStall_ns);
  if (steps_left_ > 0 && (step_topic_.empty() || step_topic_ == topic)) --steps_left_;
}

Playback::AtEnd Playback::reachEnd() {
  if (plan_.passes == 0 || pass_ < plan_.passes) {
    ++pass_;
    return AtEnd::kAgain;
  }
  return is_playing_ ? AtEnd::kOver : AtEnd::kHold;
}

std::uint64_t Playback::position(std::int64_t now_ns) const {
  if (!is_playing_ || pacer_.rate() <= 0.0) return head_ns_;
  return std::clamp(pacer_.stepAt(now_ns), head_ns_, std::max(head_ns_, next_ns_));
}

}  // namespace baton
