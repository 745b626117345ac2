#include "mcap/cursor.hpp"

#include <algorithm>
#include <utility>

#include "mcap/contents.hpp"

namespace baton::mcap {
namespace {

/// Heap algorithms keep the largest in front: turn the order round.
constexpr auto kLater = [](const auto& a, const auto& b) { return b < a; };

}  // namespace

MessageCursor::MessageCursor(const InputFile& file, const FileIndex& index, const ReaderOptions& options,
                             const MessageFilter& filter)
    : index_(index), filter_(filter), loader_(file, options) {
  const bool wants_all = filter.channels.empty() && filter.topics.empty();
  for (const auto& [id, channel] : index.channels) {
    Route route{.channel = &channel,
                .is_wanted = wants_all || std::ranges::count(filter.channels, id) > 0 ||
                             std::ranges::count(filter.topics, channel.topic) > 0};
    if (const auto schema = index.schemas.find(channel.schema_id); schema != index.schemas.end()) {
      route.schema = &schema->second;
    }
    routes_.resize(static_cast<std::size_t>(id) + 1);  // the map goes upwards
    routes_.back() = route;
  }
  const auto isWanted = [&](ChannelId id) {
    return static_cast<std::size_t>(id) < routes_.size() && routes_[static_cast<std::size_t>(id)].is_wanted;
  };
  for (std::size_t i = 0; i < index.extents.size(); ++i) {
    const Extent& extent = index.extents[i];
    if (extent.end_time_ns < filter.start_time_ns || extent.start_time_ns > filter.end_time_ns) continue;
    if (!extent.channels.empty() && std::ranges::none_of(extent.channels, isWanted)) continue;
    queue({.time_ns = keyTime(extent.start_time_ns), .extent = i, .loaded = nullptr});
  }
}

std::uint64_t MessageCursor::keyTime(std::uint64_t log_time_ns) const {
  return filter_.order == MessageFilter::Order::kLogTime ? log_time_ns : 0;
}

void MessageCursor::queue(Candidate candidate) {
  queue_.push_back(std::move(candidate));
  std::ranges::push_heap(queue_, kLater);
}

MessageCursor::Candidate MessageCursor::takeFirst() {
  std::ranges::pop_heap(queue_, kLater);
  Candidate first = std::move(queue_.back());
  queue_.pop_back();
  return first;
}

bool MessageCursor::next(MessageView& message) {
  while (true) {
    if (current_.loaded) {
      LoadedExtent& loaded = *current_.loaded;
      if (loaded.position == loaded.entries.size()) {
        spare_.push_back(std::move(current_.loaded));
        continue;
      }
      current_.time_ns = keyTime(loaded.entries[loaded.position].log_time_ns);
      if (queue_.empty() || current_ < queue_.front()) {
        const Entry& entry = loaded.entries[loaded.position++];
        const Message found = decodeMessage(loaded.records.subspan(entry.offset, entry.length));
        const Route& route = routes_[static_cast<std::size_t>(entry.channel)];
        message = {.channel = route.channel,
                   .schema = route.schema,
                   .sequence = found.sequence,
                   .log_time_ns = found.log_time_ns,
                   .publish_time_ns = found.publish_time_ns,
                   .data = found.data};
        return true;
      }
      queue(std::exchange(current_, {}));
    }
    if (queue_.empty()) return false;
    current_ = takeFirst();
    if (!current_.loaded) load(current_);
  }
}

/// Leaves candidate.loaded null when the extent is damaged and the caller wants to go on without it.
void MessageCursor::load(Candidate& candidate) {
  std::unique_ptr<LoadedExtent> loaded;
  if (spare_.empty()) {
    loaded = std::make_unique<LoadedExtent>();
  } else {
    loaded = std::move(spare_.back());
    spare_.pop_back();
  }
  loaded->position = 0;
  loaded->entries.clear();
  const Extent& extent = index_.extents[candidate.extent];
  const bool is_sound = loader_.guarded(extent, [&] {
    loaded->records = loader_.load(extent, loaded->storage);
    collect(extent, *loaded);
  });
  (is_sound ? candidate.loaded : spare_.emplace_back()) = std::move(loaded);
}

void MessageCursor::collect(const Extent& extent, LoadedExtent& loaded) const {
  std::map<ChannelId, std::optional<ChannelId>> meanings;  // where they are not those of the index
  auto change = extent.meanings.begin();
  std::string contradiction;  // to the index
  const BadRecords bad = forEachRecord(loaded.records, [&](const RecordView& record, std::size_t at) {
    if (record.opcode != Opcode::kMessage) return;
    const Message message = decodeMessage(record.body);
    for (; change != extent.meanings.end() && change->from <= at; ++change) meanings[change->id] = change->means;
    ChannelId channel = message.channel_id;
    if (const auto other = meanings.find(channel); other != meanings.end()) {
      if (!other->second) return;  // it has none, which was reported when the file was indexed
      channel = *other->second;
    }
    const auto id = static_cast<std::size_t>(channel);
    if (id >= routes_.size() || routes_[id].channel == nullptr) {
      contradiction = "a message belongs to channel " + std::to_string(id) + ", which is not known";
      return;
    }
    // The order of the chunks rests on what their index says.
    if (filter_.order == MessageFilter::Order::kLogTime &&
        (message.log_time_ns < extent.start_time_ns || message.log_time_ns > extent.end_time_ns)) {
      contradiction = "a message has log time " + std::to_string(message.log_time_ns) + ", its index says " +
                      std::to_string(extent.start_time_ns) + " to " + std::to_string(extent.end_time_ns);
      return;
    }
    const bool is_in_time = message.log_time_ns >= filter_.start_time_ns && message.log_time_ns <= filter_.end_time_ns;
    if (!routes_[id].is_wanted || !is_in_time) return;
    loaded.entries.push_back({.log_time_ns = message.log_time_ns,
                              .offset = at + kRecordHeadBytes,
                              .length = record.body.size(),
                              .channel = channel});
  });
  if (!contradiction.empty()) throw FormatError(contradiction);
  // What is left of a damaged chunk was reported when the file was indexed.
  if (!bad.first.empty() && !loader_.isTolerant()) throw FormatError(bad.first);
  const auto byTime = [](const Entry& a, const Entry& b) { return a.log_time_ns < b.log_time_ns; };
  if (filter_.order == MessageFilter::Order::kLogTime && !std::ranges::is_sorted(loaded.entries, byTime)) {
    std::ranges::stable_sort(loaded.entries, byTime);
  }
}

}  // namespace baton::mcap
