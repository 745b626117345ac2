#include "bag/selection.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>

#include "base/plural.hpp"
#include "base/text.hpp"
#include "control/nearest_name.hpp"
#include "mcap/lookup.hpp"
#include "runtime/recorded_take.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

constexpr std::uint64_t kShowSelectionEvery = 4096;

}  // namespace

void addTopicSelection(CLI::App& command, Selection& selection, const char* name, const char* text) {
  addRecording(command, selection.recording, name, text);
  command.add_option("--topics", selection.topics, "only these topics: a,b,c")->delimiter(',')->allow_extra_args(false);
}

mcap::MessageFilter filterOf(const Selection& selection, const RecordingRange& range, const mcap::Source& reader) {
  const std::vector<std::string> known = mcap::topicNames(reader);
  for (const std::string& topic : selection.topics) {
    if (!std::ranges::binary_search(known, topic)) throw UsageError(escaped(unknownName("topic", topic, known)));
  }
  return {.topics = selection.topics, .start_time_ns = range.startTime(), .end_time_ns = range.endTime()};
}

SelectedMessages::SelectedMessages(const Selection& selection)
    : found_(findRecording(selection.recording)),
      reader_(found_.files,
              [this](const std::filesystem::path& file, const mcap::Damage& damage) {
                complain(file.string(), mcap::describe(damage) + "; left out");
              }),
      range_(selection.range, reader_, found_.files.string()),
      filter_(filterOf(selection, range_, reader_)),
      has_range_(!selection.range.isAll()) {
  for (const std::string& hole : found_.missing) complain(hole);
  const mcap::FileInfo& info = reader_.info();
  if (!info.is_complete) {
    complain(mcap::incompletenessOf(info));
  } else if (!info.problem.empty() && !info.is_unindexed) {
    warn(found_.files.string(), info.problem);
  }
  for (const std::string& text : info.contradictions) warn(found_.files.string(), text);
  if (has_range_) return;
  if (const std::uint32_t resets = resetsIn(reader_); resets > 0) {
    warn(found_.files.string(),
         fmt::format("the run was reset ({} times): steps before the last reset are among these; "
                     "--from-step 0 leaves them out",
                     resets));
  }
}

void SelectedMessages::warn(const std::string& file, const std::string& problem) {
  progress_.show("");
  sayWarning(file + ": " + problem);
}

void SelectedMessages::complain(const std::string& file, const std::string& problem) {
  warn(file, problem);
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
  mcap::JoinedCursor messages = reader_.messages(filter_);
  std::uint64_t done = 0;
  bool has_any = false;
  for (mcap::MessageView message; messages.next(message);) {
    if (!range_.takes(message)) continue;
    has_any = true;
    if (!use(message)) break;
    if (++done % kShowSelectionEvery != 0 || doing.empty()) continue;
    const double part = std::min(1.0, static_cast<double>(done) / expected);
    progress_.show(doing + " " + progressBar(part) + " " + counted(done, "message"));
  }
  progress_.show("");
  if (!has_any && has_range_) throw nothingChosen(reader_, found_.files.string());
}

}  // namespace baton
