#include "mcap/copy.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace baton::mcap {
namespace {

/// work(), and what keeps it from reading a record there, unless that is known.
template <class Work>
void guard(std::set<Damage>& losses, std::uint64_t offset, std::uint64_t length, Work work) {
  try {
    work();
  } catch (const FormatError& error) {
    const auto known = losses.lower_bound({.offset = offset});
    if (known != losses.end() && known->offset == offset) return;
    losses.insert({.offset = offset, .length = length, .reason = error.what()});
  }
}

/// What a summary counts and the data do not have is lost, too; where nothing is lost it is the summary that is wrong.
void count(const Reader& reader, Recovery& result) {
  result.lost_bytes = lengthOf(result.lost);
  for (const Damage& one : result.lost) {
    result.lost_messages += one.messages;
    result.lost_chunks += one.chunks;
  }
  if (result.lost.empty() || !result.info.claimed) return;
  const auto raise = [](std::uint64_t& lost, std::uint64_t claimed, std::uint64_t there) {
    lost = std::max(lost, claimed - std::min(claimed, there));
  };
  raise(result.lost_messages, result.info.claimed->message_count, result.messages);
  const std::uint64_t met = reader.statistics().chunk_count;
  raise(result.lost_chunks, result.info.claimed->chunk_count, met - std::min(met, result.lost_chunks));
}

}  // namespace

Copier::Copier(const std::filesystem::path& out, const WriterOptions& options) : writer_(out, options) {}

Copier::~Copier() {
  if (!is_finished_) writer_.discard();
}

ChannelId Copier::channel(const Channel& channel, const Schema* schema) {
  if (const auto known = known_.find(&channel); known != known_.end()) return known->second;
  Channel copy = channel;
  copy.schema_id = schema == nullptr ? kNoSchema : writer_.addSchema(schema->name, schema->encoding, schema->data);
  copy.id = ChannelId{0};
  Bytes content;
  appendChannel(content, copy);
  const auto [same, is_new] = written_.try_emplace(std::string(asText(content)));
  if (is_new) same->second = writer_.addChannel(copy.topic, copy.message_encoding, copy.schema_id, copy.metadata);
  return known_[&channel] = same->second;
}

void Copier::channels(const Reader& reader) {
  for (const auto& [id, one] : reader.channels()) {
    const auto schema = reader.schemas().find(one.schema_id);
    channel(one, schema == reader.schemas().end() ? nullptr : &schema->second);
  }
  for (const auto& [id, schema] : reader.schemas()) writer_.addSchema(schema.name, schema.encoding, schema.data);
}

void Copier::message(const MessageView& message) {
  writer_.write(channel(*message.channel, message.schema), message.sequence, message.log_time_ns,
                message.publish_time_ns, message.data);
}

void Copier::attachment(const std::string& name, const AttachmentIndex& index, ByteView data) {
  writer_.addAttachment(name, index.media_type, index.log_time_ns, index.create_time_ns, data);
}

void Copier::finish() {
  writer_.close();
  is_finished_ = true;
}

Recovery recover(const std::filesystem::path& in, const std::filesystem::path& out, const RecoverOptions& options) {
  Recovery result;
  std::set<Damage> losses;  // once each: passes over the file come across the same
  ReaderOptions reading = options.reader;
  reading.on_damage = [&losses](const Damage& damage) { losses.insert(damage); };
  const auto tell = [&options](double part) {
    if (options.progress) options.progress(part);
  };
  // The file is read twice: the first half of the work is to find what is there.
  double begun = 0.0;
  reading.on_progress = [&](std::uint64_t done, std::uint64_t of) {
    begun = 0.5;
    tell(begun * static_cast<double>(done) / static_cast<double>(of));
  };
  const Reader reader(in, reading);
  result.info = reader.info();
  losses.insert(result.info.cuts.begin(), result.info.cuts.end());

  WriterOptions writing = options.writer;
  writing.profile = result.info.header.profile;
  Copier copy(out, writing);
  copy.channels(reader);
  const auto total = static_cast<double>(std::max<std::uint64_t>(1, reader.statistics().message_count));
  reader.forEachMessage({.order = MessageFilter::Order::kFile}, [&](const MessageView& message) {
    copy.message(message);
    if (++result.messages % 0x4000 == 0) tell(begun + (1.0 - begun) * static_cast<double>(result.messages) / total);
  });
  // Last, when it is known whether something was lost, which is as true when it is one of them: first try them all.
  std::vector<Metadata> metadata;
  for (const MetadataIndex& index : reader.metadataIndexes()) {
    guard(losses, index.offset, index.length, [&] { metadata.push_back(reader.readMetadata(index)); });
  }
  std::vector<const AttachmentIndex*> attachments;
  for (const AttachmentIndex& index : reader.attachments()) {
    guard(losses, index.offset, index.length, [&] {
      (void)reader.readAttachment(index);
      attachments.push_back(&index);
    });
  }
  // Bytes between chunks were changed: whether one of them had been a chunk's first, nobody can tell.
  const bool is_as_written = reader.dataCrcMatches().value_or(true);
  const auto nameOf = [&](const std::string& name) {
    const bool is_one = losses.empty() && is_as_written && result.info.beginnings.size() == 1;
    return is_one || !options.lossy_name ? name : options.lossy_name(name);
  };
  for (const Metadata& one : metadata) copy.metadata(nameOf(one.name), one.values);
  for (const AttachmentIndex* index : attachments) {
    copy.attachment(nameOf(index->name), *index, reader.readAttachment(*index));
  }
  copy.finish();
  result.attachments = attachments.size();
  result.metadata = metadata.size();
  result.lost.assign(losses.begin(), losses.end());
  count(reader, result);
  result.is_changed = !is_as_written;
  result.is_whole = result.lost.empty() && is_as_written && result.info.is_complete && result.info.problem.empty() &&
                    result.info.contradictions.empty() && result.info.unknown_records == 0;
  return result;
}

}  // namespace baton::mcap
