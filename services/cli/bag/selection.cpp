#include "bag/selection.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "base/text.hpp"
#include "control/nearest_name.hpp"
#include "mcap/lookup.hpp"
#include "runtime/command_line.hpp"

namespace baton {
namespace {

constexpr std::uint64_t kShowSelectionEvery = 4096;

}  // namespace

void addTopicSelection(CLI::App& command, Selection& selection) {
  command.add_option("file", selection.file, "recording (MCAP)")->required();
  command.add_option("--topics", selection.topics, "only these topics: a,b,c")->delimiter(',')->allow_extra_args(false);
}

void addTimeSelection(CLI::App& command, Selection& selection) {
  command.add_option("--from", selection.from_s, "start here, in s of log time from the recording's first message")
      ->check(notNegative());
  command.add_option("--to", selection.to_s, "end here, likewise; a message at that time is taken")
      ->check(notNegative());
}

mcap::MessageFilter filterOf(const Selection& selection, const mcap::Reader& reader) {
  const std::vector<std::string> known = mcap::topicNames(reader);
  for (const std::string& topic : selection.topics) {
    if (!std::ranges::binary_search(known, topic)) throw UsageError(escaped(unknownName("topic", topic, known)));
  }
  mcap::MessageFilter filter{.topics = selection.topics};
  if (selection.from_s) filter.start_time_ns = mcap::logTimeAt(reader, *selection.from_s);
  if (selection.to_s) filter.end_time_ns = mcap::logTimeAt(reader, *selection.to_s);
  if (filter.end_time_ns < filter.start_time_ns) throw UsageError("--to: expected a time that is not before --from");
  if (filter.start_time_ns > reader.statistics().end_time_ns) {
    throw UsageError(
        fmt::format("--from: expected a time in {}, which ends {:.6f} s behind its first message, found {}",
                    selection.file, mcap::durationOf(reader), *selection.from_s));
  }
  return filter;
}

SelectedMessages::SelectedMessages(const Selection& selection)
    : file_(selection.file), reader_(selection.file, {.on_damage = [this](const mcap::Damage& damage) {
                                       if (damage_.insert(damage).second)
                                         complain(mcap::describe(damage) + "; left out");
                                     }}) {
  const mcap::FileInfo& info = reader_.info();
  if (!info.is_complete) {
    complain("it was cut: " + info.problem);
  } else if (!info.problem.empty() && !info.is_unindexed) {
    warn(info.problem);
  }
  for (const std::string& text : info.contradictions) warn(text);
  filter_ = filterOf(selection, reader_);
}

void SelectedMessages::warn(const std::string& problem) {
  progress_.show("");
  std::fprintf(stderr, "baton: warning: %s: %s\n", file_.c_str(), escaped(problem).c_str());
}

void SelectedMessages::complain(const std::string& problem) {
  warn(problem);
  has_problem_ = true;
}

/// As the file counts them; those outside of the chosen time too.
std::uint64_t SelectedMessages::expectedMessages() const {
  if (filter_.topics.empty()) return reader_.statistics().message_count;
  std::uint64_t sum = 0;
  for (const auto& [id, count] : reader_.statistics().channel_message_counts) {
    const auto channel = reader_.channels().find(id);
    if (channel != reader_.channels().end() && std::ranges::count(filter_.topics, channel->second.topic) > 0) {
      sum += count;
    }
  }
  return sum;
}

void SelectedMessages::forEach(const std::string& doing, const std::function<bool(const mcap::MessageView&)>& use) {
  const auto expected = static_cast<double>(std::max<std::uint64_t>(1, expectedMessages()));
  mcap::MessageCursor messages = reader_.messages(filter_);
  std::uint64_t done = 0;
  for (mcap::MessageView message; messages.next(message) && use(message);) {
    if (++done % kShowSelectionEvery != 0 || doing.empty()) continue;
    const double part = std::min(1.0, static_cast<double>(done) / expected);
    progress_.show(doing + " " + progressBar(part) + " " + std::to_string(done) + " messages");
  }
  progress_.show("");
}

}  // namespace baton
