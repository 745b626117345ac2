#include "bag/log_times.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace baton {
namespace {

constexpr std::uint64_t kHole_ns = 1'000'000'000;
constexpr std::uint64_t kTimesTheUsual = 10;     // a hole is longer than so many usual distances
constexpr std::size_t kMostStretches = 1000;     // of a recording with more, such holes are the rhythm
constexpr std::uint64_t kBack_ns = 100'000'000;  // writers that share a recorder may swap places within less
constexpr std::uint64_t kMostAtOnce = 100;       // messages of a channel with one time

}  // namespace

void LogTimes::add(mcap::ChannelId channel_id, std::uint64_t log_time_ns) {
  ++messages_;
  const auto slot = static_cast<std::size_t>(channel_id);
  if (slot >= channels_.size()) channels_.resize(slot + 1);
  Channel& channel = channels_[slot];
  const std::uint64_t back_ns = channel.last_ns > log_time_ns ? channel.last_ns - log_time_ns : 0;
  if (back_ns > std::max(kBack_ns, back_.amount)) back_ = {back_ns, channel.last_ns};
  channel.repeated = log_time_ns == channel.last_ns ? channel.repeated + 1 : 1;
  channel.last_ns = log_time_ns;
  if (channel.repeated > still_.amount) still_ = {channel.repeated, log_time_ns};
  extend(log_time_ns);
}

/// Puts the time into the stretch that reaches up to it, and joins those that it connects.
void LogTimes::extend(std::uint64_t log_time_ns) {
  if (stretches_.size() > kMostStretches) return;
  const auto reaches = [](std::uint64_t from, std::uint64_t to) { return to <= from || to - from <= kHole_ns; };
  auto after = stretches_.upper_bound(log_time_ns);
  auto home = after;
  if (after != stretches_.begin() && reaches(std::prev(after)->second, log_time_ns)) {
    home = std::prev(after);
    home->second = std::max(home->second, log_time_ns);
  } else {
    home = stretches_.emplace_hint(after, log_time_ns, log_time_ns);
  }
  if (after != stretches_.end() && reaches(home->second, after->first)) {
    home->second = std::max(home->second, after->second);
    stretches_.erase(after);
  }
}

std::string LogTimes::secondsText(std::uint64_t log_time_ns) const {
  return fmt::format("{:.3f} s", static_cast<double>(log_time_ns - stretches_.begin()->first) * 1e-9);
}

/// Empty without a hole that is out of the ordinary.
std::string LogTimes::holesText() const {
  if (stretches_.size() < 2 || stretches_.size() > kMostStretches || messages_ < 3) return "";
  const std::uint64_t duration = stretches_.rbegin()->second - stretches_.begin()->first;
  Jump longest;
  std::size_t others = 0;
  for (auto next = std::next(stretches_.begin()), one = stretches_.begin(); next != stretches_.end(); one = next++) {
    const std::uint64_t hole = next->first - one->second;
    const std::uint64_t usual = (duration - hole) / (messages_ - 2);
    if (hole / kTimesTheUsual <= usual) continue;
    if (longest.amount > 0) ++others;
    if (hole > longest.amount) longest = {hole, one->second};
  }
  if (longest.amount == 0) return "";
  return fmt::format(
      "nothing was logged for {:.3f} s from {} on{}: a pause of all writers, or the clock was set forwards; "
      "`baton replay --skip-gaps 1` does not wait there",
      static_cast<double>(longest.amount) * 1e-9, secondsText(longest.at_ns),
      others == 0 ? "" : fmt::format(" (and {} shorter ones)", others));
}

std::vector<std::string> LogTimes::findings() const {
  std::vector<std::string> found;
  if (const std::string holes = holesText(); !holes.empty()) found.push_back(holes);
  if (back_.amount > 0) {
    found.push_back(
        fmt::format("the log times of a writer go back by {:.3f} s after {}: the clock was set back, and what is "
                    "shown in the order of log time is not in the order in which it was written",
                    static_cast<double>(back_.amount) * 1e-9, secondsText(back_.at_ns)));
  }
  if (still_.amount > kMostAtOnce) {
    found.push_back(
        fmt::format("{} messages of one writer have the same log time, {}: the clock was set back, or "
                    "there was none",
                    still_.amount, secondsText(still_.at_ns)));
  }
  return found;
}

}  // namespace baton
