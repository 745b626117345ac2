#include "playlist.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "control/nearest_name.hpp"
#include "dds/topics.hpp"
#include "endpoints.hpp"
#include "mcap/lookup.hpp"

namespace baton {
namespace {

/// A replay that was recorded would be obeyed, and taken for this one.
bool isReplayersOwn(const std::string& topic) {
  return topic == dds::topics::kReplayRequest.name || topic == dds::topics::kReplayReply.name ||
         topic == dds::topics::kReplayStatus.name;
}

}  // namespace

Playlist::Playlist(const ReplayOptions& options)
    : found_(findRecording(options.recording)),
      has_range_(!options.range.isAll()),
      reader_(found_.files,
              [this](const std::filesystem::path& file, const mcap::Damage& damage) { noteDamage(file, damage); }),
      range_(options.range, reader_, found_.files.string()) {
  for (const std::string& hole : found_.missing) noteProblem(hole);
  if (!reader_.info().is_complete) noteProblem(mcap::incompletenessOf(reader_.info()));
  for (const std::string& text : reader_.info().contradictions) spdlog::warn("{}", escaped(text));
  checkNames(options);
  filter_.start_time_ns = std::max(range_.startTime(), startTime());
  filter_.end_time_ns = range_.endTime();
  chooseChannels(options);
  if (!options.without_latched) latched_ = latchedBefore(reader_, filter_);
  for (LatchedMessage& one : latched_) one.view.log_time_ns = filter_.start_time_ns;  // due at once
  const std::uint64_t chosen = countMessages();
  if (chosen == 0 && has_range_) throw nothingChosen(reader_, found_.files.string());
  total_ = chosen + latched_.size();
  rewind();
}

void Playlist::leaveOut(mcap::ChannelId id, const std::string& reason) {
  noteLeftOut(reason);
  endpoints_.erase(id);
  std::erase(filter_.channels, id);
  std::erase_if(latched_, [&](const LatchedMessage& one) { return one.view.channel->id == id; });
  expectTopics();
  total_ = countMessages() + latched_.size();
}

void Playlist::noteLeftOut(const std::string& reason) {
  noteProblem(reason + "; it is left out (--topics chooses what is replayed)");
}

void Playlist::expectTopics() const {
  if (!endpoints_.empty()) return;
  throw UsageError(found_.files.string() + ": expected a topic to replay, found none" +
                   (problems_.empty() ? "" : ": " + problems_.back()));
}

void Playlist::noteProblem(const std::string& problem) {
  spdlog::warn("{}", escaped(problem));
  problems_.push_back(problem);
}

void Playlist::noteDamage(const std::filesystem::path& file, const mcap::Damage& damage) {
  noteProblem((found_.files.paths().size() > 1 ? file.string() + ": " : "") + mcap::describe(damage));
}

void Playlist::checkNames(const ReplayOptions& options) const {
  const std::vector<std::string> known = mcap::topicNames(reader_);
  const auto check = [&](const std::string& topic) {
    if (!std::binary_search(known.begin(), known.end(), topic))
      throw UsageError(escaped(unknownName("topic", topic, known)));
  };
  for (const std::string& topic : options.topics) check(topic);
  for (const auto& [old_name, new_name] : options.remap) check(old_name);
}

void Playlist::chooseChannels(const ReplayOptions& options) {
  for (const auto& [id, channel] : reader_.channels()) {
    const auto& wanted = options.topics;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), channel.topic) == wanted.end()) continue;
    const auto schema = reader_.schemas().find(channel.schema_id);
    try {
      dds::EndpointOptions endpoint =
          replayEndpoint(channel, schema == reader_.schemas().end() ? nullptr : &schema->second, options.remap);
      if (isReplayersOwn(endpoint.topic)) {
        spdlog::info("{} is left out: this replay has a topic of that name (--remap gives it another)",
                     escaped(endpoint.topic));
        continue;
      }
      endpoints_.emplace(id, std::move(endpoint));
    } catch (const UsageError& error) {
      noteLeftOut(error.what());
    }
  }
  for (const auto& [topic, reason] : contradictions(endpoints_)) {
    noteLeftOut(reason);
    std::erase_if(endpoints_, [&name = topic](const auto& entry) { return entry.second.topic == name; });
  }
  for (const auto& [id, endpoint] : endpoints_) filter_.channels.push_back(id);
  expectTopics();
}

std::uint64_t Playlist::countMessages() {
  std::uint64_t count = 0;
  if (has_range_) {
    reader_.forEachMessage(filter_, [&](const mcap::MessageView& message) { count += range_.takes(message) ? 1 : 0; });
    return count;
  }
  const auto& counts = reader_.statistics().channel_message_counts;
  for (const mcap::ChannelId id : filter_.channels) {
    if (const auto found = counts.find(id); found != counts.end()) count += found->second;
  }
  return count;
}

bool Playlist::next(mcap::MessageView& message) {
  if (next_latched_ < latched_.size()) {
    message = latched_[next_latched_++].view;
    return true;
  }
  while (cursor_->next(message)) {
    if (range_.takes(message)) return true;
  }
  return false;
}

void Playlist::seek(std::uint64_t log_time_ns) {
  mcap::MessageFilter filter = filter_;
  filter.start_time_ns = std::max(log_time_ns, filter_.start_time_ns);
  cursor_.emplace(reader_.messages(filter));
  next_latched_ = latched_.size();
}

void Playlist::rewind() {
  seek(filter_.start_time_ns);
  next_latched_ = 0;
}

std::vector<std::string> Playlist::topics() const {
  std::set<std::string> names;
  for (const auto& [id, endpoint] : endpoints_) names.insert(reader_.channels().at(id).topic);
  return {names.begin(), names.end()};
}

std::uint64_t Playlist::duration() const {
  return std::max(reader_.statistics().end_time_ns, startTime()) - startTime();
}

std::uint64_t Playlist::firstPosition() const { return std::min(filter_.start_time_ns - startTime(), duration()); }

std::uint64_t Playlist::lastPosition() const {
  return std::min(std::max(filter_.end_time_ns, startTime()) - startTime(), duration());
}

}  // namespace baton
