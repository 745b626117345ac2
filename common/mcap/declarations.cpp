#include "mcap/declarations.hpp"

#include <utility>

namespace baton::mcap {
namespace {

void appendDeclaration(Bytes& out, const Schema& schema) { appendSchema(out, schema); }
void appendDeclaration(Bytes& out, const Channel& channel) { appendChannel(out, channel); }

/// Puts a declaration into the index, under its own id unless that stands for another one there. Returns its id.
template <class Id, class Declared>
Id enter(std::map<Id, Declared>& index, std::map<std::string, Id>& renamed, unsigned& free_id, Declared declared) {
  const auto [same, is_new] = index.try_emplace(declared.id, declared);
  if (is_new || same->second == declared) return declared.id;
  declared.id = Id{0};
  Bytes record;
  appendDeclaration(record, declared);
  const std::string content(asText(record));
  if (const auto known = renamed.find(content); known != renamed.end()) return known->second;
  while (free_id > 0 && index.contains(Id{static_cast<std::uint16_t>(free_id)})) --free_id;
  if (free_id == 0) throw FormatError("it declares more schemas or channels than there are ids");
  declared.id = Id{static_cast<std::uint16_t>(free_id)};
  index.emplace(declared.id, declared);
  return renamed[content] = declared.id;
}

}  // namespace

std::optional<Schema> Declarations::take(Schema schema) {
  const SchemaId id = schema.id;
  if (id == kNoSchema) return std::nullopt;  // invalid, and to be ignored
  const SchemaId means = enter(index_.schemas, renamed_schemas_, free_schema_, std::move(schema));
  const auto [live, is_new] = schemas_.try_emplace(id, means);
  const SchemaId before = std::exchange(live->second, means);
  // Its channels were declared with the id in the file: from here on they have the later schema.
  if (before != means || (is_new && means != id)) ++generation_;
  return before == means ? std::nullopt : std::optional(index_.schemas.at(before));
}

std::optional<Channel> Declarations::take(Channel channel) {
  const auto slot = static_cast<std::size_t>(channel.id);
  if (slot >= channels_.size()) channels_.resize(slot + 1);
  std::optional<Live>& live = channels_[slot];
  const bool is_new = !live;
  if (is_new) live.emplace();
  if (!is_new && live->declared == channel) return std::nullopt;
  const ChannelId before = live->means;
  live->declared = std::move(channel);
  resolve(*live);
  return is_new || before == live->means ? std::nullopt : std::optional(index_.channels.at(before));
}

void Declarations::resolve(Live& live) {
  Channel channel = live.declared;
  if (const auto schema = schemas_.find(channel.schema_id); schema != schemas_.end()) {
    channel.schema_id = schema->second;
  }
  live.means = enter(index_.channels, renamed_channels_, free_channel_, std::move(channel));
  live.generation = generation_;
}

std::optional<ChannelId> Declarations::meaningOf(ChannelId id) {
  const auto slot = static_cast<std::size_t>(id);
  if (slot >= channels_.size() || !channels_[slot]) {
    if (fallback_ == nullptr) return std::nullopt;
    const auto channel = fallback_->channels.find(id);
    if (channel == fallback_->channels.end()) return std::nullopt;
    const auto schema = fallback_->schemas.find(channel->second.schema_id);
    if (schema != fallback_->schemas.end() && !schemas_.contains(schema->first)) (void)take(schema->second);
    (void)take(channel->second);
  }
  Live& live = *channels_[slot];
  if (live.generation != generation_) resolve(live);
  return live.means;
}

std::vector<std::string> Declarations::withoutSchema() {
  std::vector<std::string> found;
  for (const std::optional<Live>& live : channels_) {
    if (!live || live->declared.schema_id == kNoSchema || schemas_.contains(live->declared.schema_id)) continue;
    const Channel& channel = live->declared;
    if (fallback_ != nullptr && fallback_->schemas.contains(channel.schema_id)) {
      index_.schemas.emplace(channel.schema_id, fallback_->schemas.at(channel.schema_id));
    } else {
      found.push_back("channel " + std::to_string(static_cast<unsigned>(channel.id)) + " (" + channel.topic +
                      ") has schema " + std::to_string(static_cast<unsigned>(channel.schema_id)) +
                      ", which is declared nowhere: its messages stay bytes");
    }
  }
  return found;
}

void Declarations::forget() {
  fallback_ = nullptr;
  schemas_.clear();
  channels_.clear();
}

}  // namespace baton::mcap
