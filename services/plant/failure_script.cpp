#include "failure_script.hpp"

#include <algorithm>

namespace baton {

FailureScript::FailureScript(const std::vector<PlannedFailure>& failures, const std::vector<std::string>& names) {
  for (const PlannedFailure& failure : failures) {
    const auto member = static_cast<int>(std::find(names.begin(), names.end(), failure.controller) - names.begin());
    if (failure.at_step) {
      events_.push_back({.step = *failure.at_step, .member = member, .commanded = failure.commanded});
    } else {
      absent_.push_back(member);
    }
    if (failure.returns_at_step) {
      events_.push_back(
          {.step = *failure.returns_at_step, .member = member, .returns = true, .restarted = failure.restarted});
    }
  }
  std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) { return a.step < b.step; });
}

std::vector<int> FailureScript::begin(std::uint64_t first_step) {
  std::vector<int> absent = absent_;
  for (next_ = 0; next_ < events_.size() && events_[next_].step < first_step; ++next_) {
    const Event& event = events_[next_];
    if (event.returns) {
      std::erase(absent, event.member);
    } else {
      absent.push_back(event.member);
    }
  }
  return absent;
}

std::optional<FailureScript::Event> FailureScript::next(std::uint64_t step) {
  if (next_ == events_.size() || events_[next_].step > step) return std::nullopt;
  return events_[next_++];
}

}  // namespace baton
