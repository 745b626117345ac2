#include "mcap/records.hpp"

#include <algorithm>
#include <cstdio>

namespace baton::mcap {
namespace {

/// Opcode, length and whatever body() appends. `extra` counts bytes of the body that follow later.
template <class Body>
void appendRecord(Bytes& out, Opcode opcode, Body body, std::uint64_t extra = 0) {
  appendNumber(out, static_cast<std::uint8_t>(opcode));
  const std::size_t length_at = out.size();
  appendNumber(out, std::uint64_t{0});
  body();
  const std::uint64_t length = out.size() - length_at - sizeof(std::uint64_t) + extra;
  std::memcpy(out.data() + length_at, &length, sizeof(length));
}

void appendString(Bytes& out, std::string_view text) { appendSized(out, asBytes(text)); }

template <class Id>
void appendId(Bytes& out, Id id) {
  appendNumber(out, static_cast<std::uint16_t>(id));
}

void appendMap(Bytes& out, const StringMap& map) {
  Bytes entries;
  for (const auto& [key, value] : map) {
    appendString(entries, key);
    appendString(entries, value);
  }
  appendSized(out, entries);
}

template <class Pairs>
void appendCounts(Bytes& out, const Pairs& pairs) {
  Bytes entries;
  for (const auto& [id, number] : pairs) {
    appendId(entries, id);
    appendNumber(entries, number);
  }
  appendSized(out, entries);
}

template <class Id>
Id takeId(ByteReader& in) {
  return Id{in.number<std::uint16_t>()};
}

std::uint64_t zerosAtBegin(ByteView bytes) {
  return static_cast<std::uint64_t>(std::ranges::find_if(bytes, [](std::byte one) { return one != std::byte{0}; }) -
                                    bytes.begin());
}

/// The fields of a body that has been written. One of zeros reads as that of an empty record with bytes behind its
/// known fields, which would be no error; but nobody writes that.
ByteReader fieldsOf(Opcode opcode, ByteView body) {
  const std::uint64_t least = leastBytes(opcode);
  if (body.size() > least && zerosAtBegin(body.first(static_cast<std::size_t>(least))) == least) {
    throw FormatError(zerosText(zerosAtBegin(body)) + ", are in the place of its fields");
  }
  return ByteReader(body);
}

StringMap takeMap(ByteReader& in) {
  StringMap map;
  ByteReader entries(in.sized());
  while (!entries.empty()) {
    std::string key = entries.string();
    map.emplace(std::move(key), entries.string());
  }
  return map;
}

}  // namespace

std::string opcodeName(Opcode opcode) {
  switch (opcode) {
    case Opcode::kInvalid: break;
    case Opcode::kHeader: return "Header";
    case Opcode::kFooter: return "Footer";
    case Opcode::kSchema: return "Schema";
    case Opcode::kChannel: return "Channel";
    case Opcode::kMessage: return "Message";
    case Opcode::kChunk: return "Chunk";
    case Opcode::kMessageIndex: return "MessageIndex";
    case Opcode::kChunkIndex: return "ChunkIndex";
    case Opcode::kAttachment: return "Attachment";
    case Opcode::kAttachmentIndex: return "AttachmentIndex";
    case Opcode::kStatistics: return "Statistics";
    case Opcode::kMetadata: return "Metadata";
    case Opcode::kMetadataIndex: return "MetadataIndex";
    case Opcode::kSummaryOffset: return "SummaryOffset";
    case Opcode::kDataEnd: return "DataEnd";
  }
  char name[16];
  std::snprintf(name, sizeof(name), "record 0x%02X", static_cast<unsigned>(opcode));
  return name;
}

std::string zerosText(std::uint64_t bytes) {
  return std::to_string(bytes) + " zero bytes, as a file system leaves them after a crash";
}

std::uint64_t leastBytes(Opcode opcode) {
  switch (opcode) {
    case Opcode::kHeader: return 4 + 4;
    case Opcode::kFooter: return 8 + 8 + 4;
    case Opcode::kSchema: return 2 + 4 + 4 + 4;
    case Opcode::kChannel: return 2 + 2 + 4 + 4 + 4;
    case Opcode::kMessage: return 2 + 4 + 8 + 8;
    case Opcode::kChunk: return 8 + 8 + 8 + 4 + 4 + 8;
    case Opcode::kMessageIndex: return 2 + 4;
    case Opcode::kChunkIndex: return 8 + 8 + 8 + 8 + 4 + 8 + 4 + 8 + 8;
    case Opcode::kAttachment: return 8 + 8 + 4 + 4 + 8 + 4;
    case Opcode::kAttachmentIndex: return 8 + 8 + 8 + 8 + 8 + 4 + 4;
    case Opcode::kStatistics: return 8 + 2 + 4 + 4 + 4 + 4 + 8 + 8 + 4;
    case Opcode::kMetadata: return 4 + 4;
    case Opcode::kMetadataIndex: return 8 + 8 + 4;
    case Opcode::kSummaryOffset: return 1 + 8 + 8;
    case Opcode::kDataEnd: return 4;
    default: return 0;
  }
}

void appendHeader(Bytes& out, const Header& header) {
  appendRecord(out, Opcode::kHeader, [&] {
    appendString(out, header.profile);
    appendString(out, header.library);
  });
}

void appendFooter(Bytes& out, const Footer& footer) {
  appendRecord(out, Opcode::kFooter, [&] {
    appendNumber(out, footer.summary_start);
    appendNumber(out, footer.summary_offset_start);
    appendNumber(out, footer.summary_crc);
  });
}

void appendSchema(Bytes& out, const Schema& schema) {
  appendRecord(out, Opcode::kSchema, [&] {
    appendId(out, schema.id);
    appendString(out, schema.name);
    appendString(out, schema.encoding);
    appendSized(out, schema.data);
  });
}

void appendChannel(Bytes& out, const Channel& channel) {
  appendRecord(out, Opcode::kChannel, [&] {
    appendId(out, channel.id);
    appendId(out, channel.schema_id);
    appendString(out, channel.topic);
    appendString(out, channel.message_encoding);
    appendMap(out, channel.metadata);
  });
}

void appendMessage(Bytes& out, const Message& message) {
  // The one record written at a high rate: its head goes in as one piece.
  std::array<std::byte, kMessageHeadBytes> head;
  std::byte* at = head.data();
  const auto put = [&at](auto number) {
    std::memcpy(at, &number, sizeof(number));
    at += sizeof(number);
  };
  put(Opcode::kMessage);
  put(std::uint64_t{kMessageHeadBytes - kRecordHeadBytes + message.data.size()});
  put(message.channel_id);
  put(message.sequence);
  put(message.log_time_ns);
  put(message.publish_time_ns);
  append(out, head);
  append(out, message.data);
}

void appendChunkHead(Bytes& out, const Chunk& chunk) {
  const auto body = [&] {
    appendNumber(out, chunk.start_time_ns);
    appendNumber(out, chunk.end_time_ns);
    appendNumber(out, chunk.plain_size);
    appendNumber(out, chunk.plain_crc);
    appendString(out, chunk.compression);
    appendNumber(out, std::uint64_t{chunk.records.size()});
  };
  appendRecord(out, Opcode::kChunk, body, chunk.records.size());
}

void appendMessageIndex(Bytes& out, const MessageIndex& index) {
  static_assert(sizeof(MessageIndex::Entry) == 16, "entries are copied as they lie in memory");
  appendRecord(out, Opcode::kMessageIndex, [&] {
    appendId(out, index.channel_id);
    appendSized(out, std::as_bytes(std::span(index.entries)));
  });
}

void appendChunkIndex(Bytes& out, const ChunkIndex& index) {
  appendRecord(out, Opcode::kChunkIndex, [&] {
    appendNumber(out, index.start_time_ns);
    appendNumber(out, index.end_time_ns);
    appendNumber(out, index.chunk_offset);
    appendNumber(out, index.chunk_length);
    appendCounts(out, index.message_index_offsets);
    appendNumber(out, index.message_index_length);
    appendString(out, index.compression);
    appendNumber(out, index.packed_size);
    appendNumber(out, index.plain_size);
  });
}

void appendAttachmentHead(Bytes& out, const Attachment& attachment) {
  const auto body = [&] {
    appendNumber(out, attachment.log_time_ns);
    appendNumber(out, attachment.create_time_ns);
    appendString(out, attachment.name);
    appendString(out, attachment.media_type);
    appendNumber(out, std::uint64_t{attachment.data.size()});
  };
  appendRecord(out, Opcode::kAttachment, body, attachment.data.size() + sizeof(std::uint32_t));
}

void appendAttachmentIndex(Bytes& out, const AttachmentIndex& index) {
  appendRecord(out, Opcode::kAttachmentIndex, [&] {
    appendNumber(out, index.offset);
    appendNumber(out, index.length);
    appendNumber(out, index.log_time_ns);
    appendNumber(out, index.create_time_ns);
    appendNumber(out, index.data_size);
    appendString(out, index.name);
    appendString(out, index.media_type);
  });
}

void appendStatistics(Bytes& out, const Statistics& statistics) {
  appendRecord(out, Opcode::kStatistics, [&] {
    appendNumber(out, statistics.message_count);
    appendNumber(out, statistics.schema_count);
    appendNumber(out, statistics.channel_count);
    appendNumber(out, statistics.attachment_count);
    appendNumber(out, statistics.metadata_count);
    appendNumber(out, statistics.chunk_count);
    appendNumber(out, statistics.start_time_ns);
    appendNumber(out, statistics.end_time_ns);
    appendCounts(out, statistics.channel_message_counts);
  });
}

void appendMetadata(Bytes& out, const Metadata& metadata) {
  appendRecord(out, Opcode::kMetadata, [&] {
    appendString(out, metadata.name);
    appendMap(out, metadata.values);
  });
}

void appendMetadataIndex(Bytes& out, const MetadataIndex& index) {
  appendRecord(out, Opcode::kMetadataIndex, [&] {
    appendNumber(out, index.offset);
    appendNumber(out, index.length);
    appendString(out, index.name);
  });
}

void appendSummaryOffset(Bytes& out, const SummaryOffset& offset) {
  appendRecord(out, Opcode::kSummaryOffset, [&] {
    appendNumber(out, static_cast<std::uint8_t>(offset.group));
    appendNumber(out, offset.group_start);
    appendNumber(out, offset.group_length);
  });
}

void appendDataEnd(Bytes& out, const DataEnd& data_end) {
  appendRecord(out, Opcode::kDataEnd, [&] { appendNumber(out, data_end.data_crc); });
}

// Braced initialisers are evaluated from left to right, so the fields below come off the bytes in their order.

Header decodeHeader(ByteView body) {
  ByteReader in(
      body);  // nothing is lost with one of zeros, and an empty one may have bytes of a later version behind it
  return {.profile = in.string(), .library = in.string()};
}

Footer decodeFooter(ByteView body) {
  ByteReader in(body);
  return {.summary_start = in.number<std::uint64_t>(),
          .summary_offset_start = in.number<std::uint64_t>(),
          .summary_crc = in.number<std::uint32_t>()};
}

Schema decodeSchema(ByteView body) {
  ByteReader in = fieldsOf(Opcode::kSchema, body);
  Schema schema{.id = takeId<SchemaId>(in), .name = in.string(), .encoding = in.string()};
  const ByteView data = in.sized();
  schema.data.assign(data.begin(), data.end());
  return schema;
}

Channel decodeChannel(ByteView body) {
  ByteReader in = fieldsOf(Opcode::kChannel, body);
  return {.id = takeId<ChannelId>(in),
          .schema_id = takeId<SchemaId>(in),
          .topic = in.string(),
          .message_encoding = in.string(),
          .metadata = takeMap(in)};
}

Message decodeMessage(ByteView body) {
  ByteReader in(body);
  return {.channel_id = takeId<ChannelId>(in),
          .sequence = in.number<std::uint32_t>(),
          .log_time_ns = in.number<std::uint64_t>(),
          .publish_time_ns = in.number<std::uint64_t>(),
          .data = in.rest()};
}

Chunk decodeChunk(ByteView body) {
  ByteReader in = fieldsOf(Opcode::kChunk, body);
  return {.start_time_ns = in.number<std::uint64_t>(),
          .end_time_ns = in.number<std::uint64_t>(),
          .plain_size = in.number<std::uint64_t>(),
          .plain_crc = in.number<std::uint32_t>(),
          .compression = in.string(),
          .records = in.bytes(in.number<std::uint64_t>())};
}

MessageIndex decodeMessageIndex(ByteView body) {
  ByteReader in = fieldsOf(Opcode::kMessageIndex, body);
  MessageIndex index{.channel_id = takeId<ChannelId>(in)};
  ByteReader entries(in.sized());
  index.entries.reserve(entries.rest().size() / sizeof(MessageIndex::Entry));
  while (!entries.empty()) {
    index.entries.push_back(
        {.log_time_ns = entries.number<std::uint64_t>(), .offset = entries.number<std::uint64_t>()});
  }
  return index;
}

ChunkIndex decodeChunkIndex(ByteView body) {
  ByteReader in(body);
  ChunkIndex index{.start_time_ns = in.number<std::uint64_t>(),
                   .end_time_ns = in.number<std::uint64_t>(),
                   .chunk_offset = in.number<std::uint64_t>(),
                   .chunk_length = in.number<std::uint64_t>()};
  ByteReader offsets(in.sized());
  while (!offsets.empty()) {
    const auto channel_id = takeId<ChannelId>(offsets);
    index.message_index_offsets.emplace_back(channel_id, offsets.number<std::uint64_t>());
  }
  index.message_index_length = in.number<std::uint64_t>();
  index.compression = in.string();
  index.packed_size = in.number<std::uint64_t>();
  index.plain_size = in.number<std::uint64_t>();
  return index;
}

AttachmentHead decodeAttachmentHead(ByteView body) {
  ByteReader in = fieldsOf(Opcode::kAttachment, body);
  AttachmentHead head{.fields = {.log_time_ns = in.number<std::uint64_t>(),
                                 .create_time_ns = in.number<std::uint64_t>(),
                                 .name = in.string(),
                                 .media_type = in.string()},
                      .data_size = in.number<std::uint64_t>()};
  head.data_offset = in.position();
  return head;
}

AttachmentIndex decodeAttachmentIndex(ByteView body) {
  ByteReader in(body);
  return {.offset = in.number<std::uint64_t>(),
          .length = in.number<std::uint64_t>(),
          .log_time_ns = in.number<std::uint64_t>(),
          .create_time_ns = in.number<std::uint64_t>(),
          .data_size = in.number<std::uint64_t>(),
          .name = in.string(),
          .media_type = in.string()};
}

Statistics decodeStatistics(ByteView body) {
  ByteReader in(body);
  Statistics statistics{.message_count = in.number<std::uint64_t>(),
                        .schema_count = in.number<std::uint16_t>(),
                        .channel_count = in.number<std::uint32_t>(),
                        .attachment_count = in.number<std::uint32_t>(),
                        .metadata_count = in.number<std::uint32_t>(),
                        .chunk_count = in.number<std::uint32_t>(),
                        .start_time_ns = in.number<std::uint64_t>(),
                        .end_time_ns = in.number<std::uint64_t>()};
  ByteReader counts(in.sized());
  while (!counts.empty()) {
    const auto channel_id = takeId<ChannelId>(counts);
    statistics.channel_message_counts[channel_id] = counts.number<std::uint64_t>();
  }
  return statistics;
}

Metadata decodeMetadata(ByteView body) {
  ByteReader in = fieldsOf(Opcode::kMetadata, body);
  return {.name = in.string(), .values = takeMap(in)};
}

MetadataIndex decodeMetadataIndex(ByteView body) {
  ByteReader in(body);
  return {.offset = in.number<std::uint64_t>(), .length = in.number<std::uint64_t>(), .name = in.string()};
}

SummaryOffset decodeSummaryOffset(ByteView body) {
  ByteReader in(body);
  return {.group = Opcode{in.number<std::uint8_t>()},
          .group_start = in.number<std::uint64_t>(),
          .group_length = in.number<std::uint64_t>()};
}

DataEnd decodeDataEnd(ByteView body) {
  ByteReader in(body);
  return {.data_crc = in.number<std::uint32_t>()};
}

std::optional<RecordView> nextRecord(ByteReader& in) {
  if (in.empty()) return std::nullopt;
  if (in.rest().front() == std::byte{0})
    throw FormatError(zerosText(zerosAtBegin(in.rest())) + ", are in the place of a record");
  const Opcode opcode{in.number<std::uint8_t>()};
  return RecordView{opcode, in.bytes(in.number<std::uint64_t>())};
}

}  // namespace baton::mcap
