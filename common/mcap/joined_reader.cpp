#include "mcap/joined_reader.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "base/error.hpp"
#include "base/plural.hpp"

namespace baton::mcap {
namespace {

/// The key of an entry that equals `wanted` in all but its number and is not taken; nothing when there is none.
template <class Id, class Value>
std::optional<Id> numberOf(const std::map<Id, Value>& known, Value wanted, const std::set<Id>& taken) {
  for (const auto& [id, one] : known) {
    wanted.id = id;
    if (!taken.contains(id) && one == wanted) return id;
  }
  return std::nullopt;
}

/// The smallest that is free; 0 means none.
template <class Id, class Value>
Id freeNumber(const std::map<Id, Value>& known) {
  unsigned next = 1;
  for (const auto& [id, one] : known) {
    if (static_cast<unsigned>(id) > next) break;
    next = static_cast<unsigned>(id) + 1;
  }
  if (next > std::numeric_limits<std::uint16_t>::max()) {
    throw UsageError("expected files with 65535 channels and schemas together at most, found more");
  }
  return Id{static_cast<std::uint16_t>(next)};
}

constexpr auto kLaterWalk = [](const auto* a, const auto* b) {
  return a->time_ns != b->time_ns ? a->time_ns > b->time_ns : a->index > b->index;
};

}  // namespace

std::string FileList::string() const {
  const std::size_t more = paths_.size() - 1;
  if (more == 0) return first().string();
  return first().string() + " and " + counted(more, "more file");
}

JoinedReader::JoinedReader(const FileList& files, const DamageSink& on_damage) {
  parts_.reserve(files.paths().size());
  for (const std::filesystem::path& path : files.paths()) {
    ReaderOptions options;
    if (on_damage) {
      options.on_damage = [on_damage, path](const Damage& damage) { on_damage(path, damage); };
    }
    parts_.push_back({.reader = std::make_unique<Reader>(path, options), .routes = {}, .repeated = {}});
  }
  if (!isOne()) join(files);
}

void JoinedReader::join(const FileList& files) {
  info_.header = file(0).info().header;
  info_.is_complete = info_.has_all_data = true;
  info_.beginnings.clear();
  bool has_other_problem = false;
  std::vector<const Reader*> before;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Part& part = parts_[i];
    const FileInfo& info = part.reader->info();
    if (info_.problem.empty() && !info.problem.empty()) info_.problem = files.paths()[i].string() + ": " + info.problem;
    for (const std::string& text : info.contradictions) {
      info_.contradictions.push_back(files.paths()[i].string() + ": " + text);
    }
    has_other_problem = has_other_problem || (!info.problem.empty() && !info.is_unindexed);
    for (const std::uint64_t one : info.beginnings) info_.beginnings.push_back(info_.file_bytes + one);
    info_.file_bytes += info.file_bytes;
    info_.complete_bytes += info.complete_bytes;
    info_.is_complete = info_.is_complete && info.is_complete;
    info_.is_cut = info_.is_cut || info.is_cut;
    info_.has_all_data = info_.has_all_data && info.has_all_data;
    if (i > 0) part.repeated = Repeated(*part.reader, before);
    before.push_back(part.reader.get());
    joinChannels(part);
    joinCounts(part);
    for (const AttachmentIndex& attachment : part.reader->attachments()) {
      attachments_.push_back(attachment);
      attached_to_.push_back(i);
    }
  }
  info_.is_unindexed = !info_.problem.empty() && !has_other_problem;
}

void JoinedReader::joinChannels(Part& part) {
  std::set<ChannelId> taken;  // by other channels of this file: two that are alike are two
  for (const auto& [id, channel] : part.reader->channels()) {
    Channel joined = channel;
    const Schema* schema = nullptr;
    if (const auto own = part.reader->schemas().find(channel.schema_id); own != part.reader->schemas().end()) {
      joined.schema_id = numberOf(schemas_, own->second, {}).value_or(SchemaId{});
      if (joined.schema_id == SchemaId{}) {
        Schema added = own->second;
        joined.schema_id = added.id = freeNumber(schemas_);
        schemas_.emplace(added.id, std::move(added));
      }
      schema = &schemas_.at(joined.schema_id);
    }
    const std::optional<ChannelId> same = numberOf(channels_, joined, taken);
    joined.id = same ? *same : channels_.contains(id) ? freeNumber(channels_) : id;
    taken.insert(joined.id);
    part.routes[id] = {&channels_.try_emplace(joined.id, joined).first->second, schema};
  }
}

void JoinedReader::joinCounts(const Part& part) {
  const Statistics& own = part.reader->statistics();
  if (own.message_count == 0) return;
  const bool is_first = statistics_.message_count == 0;
  statistics_.start_time_ns = is_first ? own.start_time_ns : std::min(statistics_.start_time_ns, own.start_time_ns);
  statistics_.end_time_ns = std::max(statistics_.end_time_ns, own.end_time_ns);
  statistics_.message_count += own.message_count - std::min(own.message_count, part.repeated.count());
  for (const auto& [id, count] : own.channel_message_counts) {
    const auto route = part.routes.find(id);
    if (route == part.routes.end()) continue;
    const auto again = part.repeated.counts().find(id);
    const std::uint64_t repeated = again == part.repeated.counts().end() ? 0 : again->second;
    statistics_.channel_message_counts[route->second.channel->id] += count - std::min(count, repeated);
  }
  statistics_.schema_count = static_cast<std::uint16_t>(schemas_.size());
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
}

Bytes JoinedReader::readAttachment(const AttachmentIndex& attachment) const {
  if (isOne()) return file(0).readAttachment(attachment);
  const auto index = static_cast<std::size_t>(&attachment - attachments_.data());
  return file(attached_to_.at(index)).readAttachment(attachment);
}

std::vector<Metadata> JoinedReader::metadata() const {
  std::vector<Metadata> all;
  for (const Part& part : parts_) {
    for (Metadata& one : part.reader->metadata()) all.push_back(std::move(one));
  }
  return all;
}

JoinedCursor JoinedReader::messages(const MessageFilter& filter) const { return JoinedCursor(*this, filter); }

void JoinedReader::forEachMessage(const MessageFilter& filter,
                                  const std::function<void(const MessageView&)>& callback) const {
  JoinedCursor cursor = messages(filter);
  for (MessageView message; cursor.next(message);) callback(message);
}

JoinedCursor::JoinedCursor(const JoinedReader& reader, const MessageFilter& filter)
    : by_time_(filter.order == MessageFilter::Order::kLogTime) {
  for (std::size_t i = 0; i < reader.parts_.size(); ++i) {
    const JoinedReader::Part& part = reader.parts_[i];
    MessageFilter own = filter;
    if (!reader.isOne() && !filter.channels.empty()) {
      own.channels.clear();
      for (const auto& [id, route] : part.routes) {
        if (std::ranges::count(filter.channels, route.channel->id) > 0) own.channels.push_back(id);
      }
      if (own.channels.empty() && own.topics.empty()) continue;  // an empty filter would be all
    }
    walks_.push_back(std::make_unique<Walk>(Walk{.part = &part,
                                                 .index = i,
                                                 .time_ns = by_time_ ? part.reader->statistics().start_time_ns : 0,
                                                 .is_read = false,
                                                 .cursor = part.reader->messages(own),
                                                 .repeated = part.repeated,
                                                 .next = {}}));
    queue(walks_.back().get());
  }
}

void JoinedCursor::queue(Walk* walk) {
  queue_.push_back(walk);
  std::ranges::push_heap(queue_, kLaterWalk);
}

/// False at the end of the file.
bool JoinedCursor::advance(Walk& walk) const {
  do {
    if (!walk.cursor.next(walk.next)) return false;
  } while (walk.repeated.takes(walk.next));
  if (by_time_) walk.time_ns = walk.next.log_time_ns;
  walk.is_read = true;
  return true;
}

bool JoinedCursor::next(MessageView& message) {
  if (current_ != nullptr) {
    Walk* last = std::exchange(current_, nullptr);
    if (advance(*last)) queue(last);
  }
  while (!queue_.empty()) {
    std::ranges::pop_heap(queue_, kLaterWalk);
    Walk* first = queue_.back();
    queue_.pop_back();
    if (!first->is_read) {  // whether its first message is the next one shows when it is there
      if (advance(*first)) queue(first);
      continue;
    }
    current_ = first;
    message = first->next;
    const auto route = first->part->routes.find(message.channel->id);
    if (route != first->part->routes.end()) {
      message.channel = route->second.channel;
      message.schema = route->second.schema;
    }
    return true;
  }
  return false;
}

}  // namespace baton::mcap
