#include "control/parameter_schedule.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxLawState = 8192;  // bytes; every law's is far smaller

void sortBySteps(std::vector<ParameterChange>& changes) {
  std::stable_sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.at_step < b.at_step; });
}

}  // namespace

ParameterSchedule::ParameterSchedule(const LawInfo& law, const RobotModel& model, ParameterValues start,
                                     std::vector<ParameterChange> planned)
    : info_(law), model_(model), start_(std::move(start)), planned_(std::move(planned)), state_(kMaxLawState) {
  for (ParameterChange& change : planned_) change.is_planned = true;
  sortBySteps(planned_);
  rewind();
}

void ParameterSchedule::rewind() { begin(start_, planned_); }

void ParameterSchedule::begin(const ParameterValues& values, std::vector<ParameterChange> waiting) {
  waiting.insert(waiting.begin(), ParameterChange{});  // the start, which changes nothing
  entries_ = made(values, std::move(waiting));
  in_force_ = 0;
  ++revision_;
}

std::vector<ParameterSchedule::Entry> ParameterSchedule::made(const ParameterValues& before,
                                                              std::vector<ParameterChange> changes) const {
  std::vector<Entry> entries;
  ParameterValues given = before;
  for (ParameterChange& change : changes) {
    Entry entry;
    for (const auto& [name, value] : change.set) given[name] = value;
    try {
      given = completeParameters(info_.parameters, given, model_.size());
      entry.law = info_.make(model_, given);
    } catch (const UsageError& error) {
      if (entries.empty()) throw;
      throw UsageError("with the change that waits for step " + std::to_string(change.at_step) + ": " + error.what());
    }
    entry.law->reset();
    for (auto& [name, value] : change.set) value = given.at(name);
    entry.values = given;
    entry.change = std::move(change);
    entries.push_back(std::move(entry));
  }
  return entries;
}

bool ParameterSchedule::advance(std::uint64_t step) noexcept {
  bool has_news = false;
  while (in_force_ + 1 < entries_.size() && entries_[in_force_ + 1].change.at_step <= step) {
    StateArchive saved = StateArchive::into(state_);
    law().archive(saved);
    ++in_force_;
    StateArchive restored = StateArchive::from(std::span(state_).first(saved.size()));
    law().archive(restored);
    has_news = true;
  }
  if (has_news) ++revision_;
  return has_news;
}

ParameterSchedule::Draft ParameterSchedule::draft(const ParameterChange& change, std::uint64_t next_step) const {
  if (change.set.empty()) throw UsageError("expected a parameter to change, found none");
  if (asked().size() >= kMaxWaiting) {
    throw UsageError("expected at most " + std::to_string(kMaxWaiting) +
                     " changes that wait for their step, found as many: let one take place first");
  }
  Draft draft;
  draft.revision = revision_;
  draft.changes.push_back(change);
  draft.changes.front().at_step = std::max(change.at_step, next_step);
  const auto waiting = entries_.begin() + static_cast<std::ptrdiff_t>(in_force_) + 1;
  const auto behind = std::find_if(waiting, entries_.end(), [&](const Entry& entry) {
    return entry.change.at_step > draft.changes.front().at_step;
  });
  draft.place = static_cast<std::size_t>(behind - entries_.begin());
  draft.before = entries_[draft.place - 1].values;
  for (auto entry = behind; entry != entries_.end(); ++entry) draft.changes.push_back(entry->change);
  return draft;
}

void ParameterSchedule::make(Draft& draft) const { draft.entries = made(draft.before, draft.changes); }

std::optional<ParameterChange> ParameterSchedule::accept(Draft& draft, std::uint64_t next_step) {
  if (draft.revision != revision_) return std::nullopt;
  ParameterChange& change = draft.entries.front().change;
  if (change.at_step < next_step) {
    // Nothing has come into force, so what waits behind it is not for earlier than next_step.
    if (draft.entries.size() > 1 && draft.entries[1].change.at_step == next_step) return std::nullopt;
    change.at_step = next_step;
  }
  const ParameterChange accepted = change;
  std::vector<Entry> now;
  now.reserve(draft.place - in_force_ + draft.entries.size());
  const auto in_force = entries_.begin() + static_cast<std::ptrdiff_t>(in_force_);
  std::move(in_force, entries_.begin() + static_cast<std::ptrdiff_t>(draft.place), std::back_inserter(now));
  std::move(draft.entries.begin(), draft.entries.end(), std::back_inserter(now));
  draft.entries = std::exchange(entries_, std::move(now));
  in_force_ = 0;
  ++revision_;
  return accepted;
}

// --- checkpoints

void ParameterSchedule::archiveValue(StateArchive& state, const ParameterSpec& spec, ParameterValue& value) const {
  if (state.isRestoring()) value = start_.at(spec.name);  // as many numbers
  if (auto* numbers = std::get_if<std::vector<double>>(&value)) {
    for (double& number : *numbers) state(number);
    return;
  }
  const auto word = std::find(spec.choices.begin(), spec.choices.end(), std::get<std::string>(value));
  auto place = static_cast<std::uint32_t>(word - spec.choices.begin());
  state(place);
  if (!state.isRestoring() || !state.isGood()) return;
  if (place >= spec.choices.size()) return state.fail();
  value = spec.choices[place];
}

/// Only what differs from the start, with what the start was.
ParameterValues ParameterSchedule::archiveInForce(StateArchive& state) const {
  ParameterValues in_force = state.isRestoring() ? start_ : values();
  for (const ParameterSpec& spec : info_.parameters) {
    ParameterValue start = start_.at(spec.name);
    ParameterValue value = in_force.at(spec.name);
    bool is_changed = value != start;
    state(is_changed);
    if (!state.isGood()) break;
    if (!is_changed) continue;
    archiveValue(state, spec, start);
    archiveValue(state, spec, value);
    if (state.isRestoring() && start == start_.at(spec.name)) in_force[spec.name] = value;
  }
  return in_force;
}

std::vector<ParameterChange> ParameterSchedule::archiveAsked(StateArchive& state) const {
  std::vector<ParameterChange> all = asked();
  auto count = static_cast<std::uint32_t>(all.size());
  state(count);
  if (state.isRestoring()) {
    if (count > kMaxWaiting) state.fail();
    all.assign(state.isGood() ? count : 0, {});
  }
  for (ParameterChange& change : all) {
    state(change.at_step);
    for (const ParameterSpec& spec : info_.parameters) {
      bool is_set = change.set.contains(spec.name);
      state(is_set);
      if (!state.isGood()) break;
      if (is_set) archiveValue(state, spec, change.set[spec.name]);
    }
  }
  return all;
}

std::vector<ParameterChange> ParameterSchedule::asked() const {
  std::vector<ParameterChange> all;
  for (std::size_t i = in_force_ + 1; i < entries_.size(); ++i) {
    if (!entries_[i].change.is_planned) all.push_back(entries_[i].change);
  }
  return all;
}

void ParameterSchedule::archive(StateArchive& state, std::uint64_t first_step) {
  const ParameterValues in_force = archiveInForce(state);
  std::vector<ParameterChange> asked_for = archiveAsked(state);
  if (!state.isRestoring() || !state.isGood()) return;
  // A run that is repeated from its recording has what was asked for in its plan.
  std::erase_if(asked_for, [&](const ParameterChange& one) {
    return std::any_of(planned_.begin(), planned_.end(), [&](const ParameterChange& planned) {
      return planned.at_step == one.at_step && planned.set == one.set;
    });
  });
  std::vector<ParameterChange> waiting = planned_;
  std::erase_if(waiting, [&](const ParameterChange& change) { return change.at_step < first_step; });
  waiting.insert(waiting.end(), asked_for.begin(), asked_for.end());
  sortBySteps(waiting);
  try {
    begin(in_force, std::move(waiting));
  } catch (const UsageError&) {
    state.fail();
  }
}

}  // namespace baton
