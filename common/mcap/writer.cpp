#include "mcap/writer.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "mcap/crc.hpp"

namespace baton::mcap {
namespace {

constexpr std::size_t kMaxIds = std::numeric_limits<std::uint16_t>::max();

template <class Id>
std::size_t slot(Id id) {
  return static_cast<std::size_t>(id) - 1;
}

WriterOptions checked(WriterOptions options) {
  if (options.chunk_bytes == 0 || options.chunk_bytes > kMaxChunkBytes) {
    throw UsageError("chunk_bytes must be 1 to " + std::to_string(kMaxChunkBytes) + ", not " +
                     std::to_string(options.chunk_bytes));
  }
  return options;
}

}  // namespace

Writer::Writer(const std::filesystem::path& path, WriterOptions options)
    : options_(checked(std::move(options))),
      // Before the file: a wrong level must not leave an empty file behind.
      compressor_(options_.compression, options_.compression_level),
      file_(path, options_.if_exists) {
  append(scratch_, kMagic);
  appendHeader(scratch_, {.profile = options_.profile, .library = options_.library});
  emit(scratch_);
}

Writer::~Writer() {
  try {
    close();
  } catch (const std::exception&) {
    // Nobody is left to tell; close() is for those who want to know.
  }
}

SchemaId Writer::addSchema(std::string_view name, std::string_view encoding, ByteView data) {
  file_.requireHealthy();
  SchemaState state{.schema = {.name = std::string(name),
                               .encoding = std::string(encoding),
                               .data = Bytes(data.begin(), data.end())}};
  Bytes record;
  appendSchema(record, state.schema);
  std::string content(asText(record));
  if (const auto same = known_.find(content); same != known_.end()) return same->second;
  if (schemas_.size() == kMaxIds) throw UsageError("an MCAP file holds at most 65535 schemas");
  state.schema.id = known_[std::move(content)] = SchemaId{static_cast<std::uint16_t>(schemas_.size() + 1)};
  appendSchema(state.record, state.schema);
  makeRoom(state.record.size());
  append(chunk_, state.record);
  declared_bytes_ += state.record.size();
  state.declared_in = chunk_number_;
  schemas_.push_back(std::move(state));
  return schemas_.back().schema.id;
}

ChannelId Writer::addChannel(std::string_view topic, std::string_view message_encoding, SchemaId schema_id,
                             const StringMap& metadata) {
  file_.requireHealthy();
  if (static_cast<std::size_t>(schema_id) > schemas_.size()) {
    throw UsageError("channel \"" + std::string(topic) + "\" names schema " +
                     std::to_string(static_cast<unsigned>(schema_id)) + ", which was not added");
  }
  if (channels_.size() == kMaxIds) throw UsageError("an MCAP file holds at most 65535 channels");
  const ChannelId id{static_cast<std::uint16_t>(channels_.size() + 1)};
  ChannelState state{.channel = {.id = id,
                                 .schema_id = schema_id,
                                 .topic = std::string(topic),
                                 .message_encoding = std::string(message_encoding),
                                 .metadata = metadata},
                     .index = {.channel_id = id}};
  appendChannel(state.record, state.channel);
  makeRoom(state.record.size(), declarationBytes(state) - state.record.size());
  declared_bytes_ += state.record.size();
  channels_.push_back(std::move(state));
  declare(channels_.back());
  return id;
}

std::size_t Writer::declarationBytes(const ChannelState& state) const {
  const SchemaId schema = state.channel.schema_id;
  return state.record.size() + (schema == kNoSchema ? 0 : schemas_[slot(schema)].record.size());
}

/// In the current chunk, unless it has the declaration already.
void Writer::declare(ChannelState& state) {
  const auto declareOnce = [this](const Bytes& record, std::uint64_t& declared_in) {
    const std::uint64_t before = std::exchange(declared_in, chunk_number_);
    if (before == chunk_number_) return;
    append(chunk_, record);
    if (before != 0) repeated_bytes_ += record.size();
  };
  if (state.channel.schema_id != kNoSchema) {
    SchemaState& schema = schemas_[slot(state.channel.schema_id)];
    declareOnce(schema.record, schema.declared_in);
  }
  declareOnce(state.record, state.declared_in);
}

void Writer::write(ChannelId channel, std::uint32_t sequence, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                   ByteView data) {
  file_.requireHealthy();
  if (slot(channel) >= channels_.size()) {
    throw UsageError("channel " + std::to_string(static_cast<unsigned>(channel)) + " was not added");
  }
  ChannelState& state = channels_[slot(channel)];
  makeRoom(kMessageHeadBytes + data.size(), declarationBytes(state));
  if (state.index.entries.empty()) {
    declare(state);
    chunk_channels_.push_back(channel);
  }
  state.index.entries.push_back({.log_time_ns = log_time_ns, .offset = chunk_.size()});
  appendMessage(chunk_, {.channel_id = channel,
                         .sequence = sequence,
                         .log_time_ns = log_time_ns,
                         .publish_time_ns = publish_time_ns,
                         .data = data});
  chunk_start_time_ns_ = chunk_messages_ == 0 ? log_time_ns : std::min(chunk_start_time_ns_, log_time_ns);
  chunk_end_time_ns_ = chunk_messages_ == 0 ? log_time_ns : std::max(chunk_end_time_ns_, log_time_ns);
  ++chunk_messages_;
  ++state.count;
  ++messages_;
  message_bytes_ += data.size();
}

void Writer::addMetadata(std::string_view name, const StringMap& values) {
  file_.requireHealthy();
  scratch_.clear();
  appendMetadata(scratch_, {.name = std::string(name), .values = values});
  pending_indexes_.push_back({.offset = pending_.size(), .length = scratch_.size(), .name = std::string(name)});
  append(pending_, scratch_);
  if (chunk_.empty()) writePending();
}

void Writer::addAttachment(std::string_view name, std::string_view media_type, std::uint64_t log_time_ns,
                           std::uint64_t create_time_ns, ByteView data) {
  flush();
  const Attachment attachment{.log_time_ns = log_time_ns,
                              .create_time_ns = create_time_ns,
                              .name = std::string(name),
                              .media_type = std::string(media_type),
                              .data = data};
  const std::uint64_t offset = file_.size();
  scratch_.clear();
  appendAttachmentHead(scratch_, attachment);
  std::uint32_t crc = 0;
  if (options_.has_crc) crc = crc32(data, crc32(ByteView(scratch_).subspan(kRecordHeadBytes)));
  emit(scratch_);
  emit(data);
  emit(std::as_bytes(std::span(&crc, 1)));
  attachment_indexes_.push_back({.offset = offset,
                                 .length = file_.size() - offset,
                                 .log_time_ns = log_time_ns,
                                 .create_time_ns = create_time_ns,
                                 .data_size = data.size(),
                                 .name = attachment.name,
                                 .media_type = attachment.media_type});
}

void Writer::flush() {
  file_.requireHealthy();
  closeChunk();
}

void Writer::sync() {
  flush();
  file_.sync();
}

void Writer::close() {
  if (std::exchange(is_closed_, true)) return;
  closeChunk();
  writeSummary();
  if (options_.sync_on_close) file_.sync();
  file_.close();
}

void Writer::discard() noexcept {
  is_closed_ = true;
  file_.discard();
}

WriterStatistics Writer::statistics() const {
  return {.messages = messages_,
          .message_bytes = message_bytes_,
          .written_messages = written_messages_,
          .chunks = chunk_indexes_.size(),
          .file_bytes = file_.size(),
          .durable_bytes = file_.durableSize(),
          .declared_bytes = declared_bytes_};
}

/// Closes the current chunk when it has no room for this record, and makes sure that adding it cannot fail half-way.
/// @param declaration_bytes  what may have to be repeated in front of it.
void Writer::makeRoom(std::size_t record_bytes, std::size_t declaration_bytes) {
  const std::size_t most = record_bytes + declaration_bytes;
  if (most > kMaxChunkBytes) {
    throw UsageError("a record of " + std::to_string(record_bytes) + " bytes with " +
                     std::to_string(declaration_bytes) + " bytes of declarations is above the limit of " +
                     std::to_string(kMaxChunkBytes));
  }
  // Repeated declarations do not count: a schema larger than a chunk must not leave room for one message only.
  const bool is_full = chunk_.size() - repeated_bytes_ + record_bytes > options_.chunk_bytes;
  if (!chunk_.empty() && (is_full || chunk_.size() + most > kMaxChunkBytes)) closeChunk();
  chunk_.reserve(std::max(options_.chunk_bytes, chunk_.size() + most));
}

void Writer::closeChunk() {
  if (chunk_messages_ > 0) {
    writeChunk();
  } else {
    // Schemas and channels alone need no chunk: as plain records no reader has to open one to find nothing.
    emit(chunk_);
  }
  chunk_.clear();
  ++chunk_number_;
  repeated_bytes_ = 0;
  writePending();
}

void Writer::writeChunk() {
  const std::uint32_t plain_crc = options_.has_crc ? crc32(chunk_) : 0;
  const ByteView records = compressor_.compress(chunk_);
  const Chunk chunk{.start_time_ns = chunk_start_time_ns_,
                    .end_time_ns = chunk_end_time_ns_,
                    .plain_size = chunk_.size(),
                    .plain_crc = plain_crc,
                    .compression = std::string(compressionName(options_.compression)),
                    .records = records};
  ChunkIndex index{.start_time_ns = chunk.start_time_ns,
                   .end_time_ns = chunk.end_time_ns,
                   .chunk_offset = file_.size(),
                   .compression = chunk.compression,
                   .packed_size = records.size(),
                   .plain_size = chunk.plain_size};
  scratch_.clear();
  appendChunkHead(scratch_, chunk);
  emit(scratch_);
  if (options_.compression == Compression::kNone && options_.has_crc) {
    // These bytes have their CRC already: join it, as taking it again would cost more than writing them.
    file_.write(records);
    data_crc_ = crc32Joined(data_crc_, plain_crc, records.size());
  } else {
    emit(records);
  }
  index.chunk_length = file_.size() - index.chunk_offset;
  // A reader finds them from here on, even when the disk ends within what follows.
  written_messages_ += std::exchange(chunk_messages_, 0);

  scratch_.clear();
  index.message_index_offsets.reserve(chunk_channels_.size());
  for (const ChannelId id : chunk_channels_) {
    MessageIndex& messages = channels_[slot(id)].index;
    index.message_index_offsets.emplace_back(id, file_.size() + scratch_.size());
    appendMessageIndex(scratch_, messages);
    messages.entries.clear();
  }
  index.message_index_length = scratch_.size();
  emit(scratch_);

  start_time_ns_ = chunk_indexes_.empty() ? chunk.start_time_ns : std::min(start_time_ns_, chunk.start_time_ns);
  end_time_ns_ = std::max(end_time_ns_, chunk.end_time_ns);
  chunk_indexes_.push_back(std::move(index));
  chunk_channels_.clear();
  if (options_.sync_chunks) file_.sync();
}

void Writer::writePending() {
  const std::uint64_t base = file_.size();
  emit(pending_);
  for (MetadataIndex& index : pending_indexes_) {
    index.offset += base;
    metadata_indexes_.push_back(std::move(index));
  }
  pending_.clear();
  pending_indexes_.clear();
}

/// DataEnd, summary, summary offsets, footer, magic.
void Writer::writeSummary() {
  Bytes data_end;
  appendDataEnd(data_end, {.data_crc = data_crc_});
  emit(data_end);

  Statistics statistics{.message_count = messages_,
                        .schema_count = static_cast<std::uint16_t>(schemas_.size()),
                        .channel_count = static_cast<std::uint32_t>(channels_.size()),
                        .attachment_count = static_cast<std::uint32_t>(attachment_indexes_.size()),
                        .metadata_count = static_cast<std::uint32_t>(metadata_indexes_.size()),
                        .chunk_count = static_cast<std::uint32_t>(chunk_indexes_.size()),
                        .start_time_ns = start_time_ns_,
                        .end_time_ns = end_time_ns_};
  for (const ChannelState& state : channels_) {
    if (state.count > 0) statistics.channel_message_counts[state.channel.id] = state.count;
  }

  const std::uint64_t summary_start = file_.size();
  Bytes summary;
  std::vector<SummaryOffset> groups;
  const auto group = [&](Opcode opcode, const auto& items, auto append_item) {
    const std::size_t begin = summary.size();
    for (const auto& item : items) append_item(summary, item);
    if (summary.size() > begin) groups.push_back({opcode, summary_start + begin, summary.size() - begin});
  };
  group(Opcode::kSchema, schemas_, [](Bytes& out, const SchemaState& state) { appendSchema(out, state.schema); });
  group(Opcode::kChannel, channels_, [](Bytes& out, const ChannelState& state) { appendChannel(out, state.channel); });
  group(Opcode::kStatistics, std::span(&statistics, 1), appendStatistics);
  group(Opcode::kChunkIndex, chunk_indexes_, appendChunkIndex);
  group(Opcode::kAttachmentIndex, attachment_indexes_, appendAttachmentIndex);
  group(Opcode::kMetadataIndex, metadata_indexes_, appendMetadataIndex);

  Footer footer{.summary_start = summary_start, .summary_offset_start = summary_start + summary.size()};
  for (const SummaryOffset& offset : groups) appendSummaryOffset(summary, offset);
  const std::size_t footer_at = summary.size();
  appendFooter(summary, footer);
  if (options_.has_crc) {
    // Over everything but the CRC's own field: write the footer again once it is known.
    footer.summary_crc = crc32(ByteView(summary).first(summary.size() - sizeof(std::uint32_t)));
    summary.resize(footer_at);
    appendFooter(summary, footer);
  }
  append(summary, kMagic);
  file_.write(summary);
}

/// Into the data section, and into its CRC.
void Writer::emit(ByteView bytes) {
  file_.write(bytes);
  if (options_.has_crc) data_crc_ = crc32(bytes, data_crc_);
}

}  // namespace baton::mcap
