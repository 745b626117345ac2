/// The records of an MCAP file, as plain structs, and their bytes (specification: mcap.dev/spec, version 0).
///
/// A record is an opcode (u8), the length of its body (u64) and the body. decodeX takes a body and throws FormatError
/// when a length inside it does not fit, or when there is nothing but zeros where its fields are, and more after them;
/// bytes behind the known fields are ignored, as the specification asks. appendX adds the whole record to `out`.
/// Structs with a ByteView borrow their data.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mcap/bytes.hpp"

namespace baton::mcap {

/// The first and the last bytes of every file.
inline constexpr std::array kMagic{std::byte{0x89}, std::byte{'M'}, std::byte{'C'},  std::byte{'A'},
                                   std::byte{'P'},  std::byte{'0'}, std::byte{'\r'}, std::byte{'\n'}};

enum class Opcode : std::uint8_t {
  kInvalid = 0x00,
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// "Chunk", "Message", ...; "record 0x42" for one this version does not know.
[[nodiscard]] std::string opcodeName(Opcode opcode);

/// "12 zero bytes, ...": records are never that.
[[nodiscard]] std::string zerosText(std::uint64_t bytes);

/// The least that a record's body holds; 0 for kinds that are not known.
[[nodiscard]] std::uint64_t leastBytes(Opcode opcode);

/// Opcode and length in front of every body.
inline constexpr std::size_t kRecordHeadBytes = 9;
/// A Footer's whole record; it may never be extended.
inline constexpr std::size_t kFooterBytes = kRecordHeadBytes + 20;
/// A Message's whole record, without its data; it may never be extended.
inline constexpr std::size_t kMessageHeadBytes = kRecordHeadBytes + 22;

enum class SchemaId : std::uint16_t {};
enum class ChannelId : std::uint16_t {};
/// The schema of a channel that has none.
inline constexpr SchemaId kNoSchema{0};

using StringMap = std::map<std::string, std::string>;

struct Header {
  std::string profile{};
  std::string library{};
};

struct Footer {
  std::uint64_t summary_start = 0;         // 0: no summary
  std::uint64_t summary_offset_start = 0;  // 0: no summary offsets
  std::uint32_t summary_crc = 0;           // from summary_start up to this field; 0: not given
};

struct Schema {
  SchemaId id{};
  std::string name{};
  std::string encoding{};
  Bytes data{};
  bool operator==(const Schema&) const = default;
};

struct Channel {
  ChannelId id{};
  SchemaId schema_id{};
  std::string topic{};
  std::string message_encoding{};
  StringMap metadata{};
  bool operator==(const Channel&) const = default;
};

struct Message {
  ChannelId channel_id{};
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  std::uint64_t publish_time_ns = 0;
  ByteView data{};
};

struct Chunk {
  std::uint64_t start_time_ns = 0;  // earliest and latest log time within; both 0 without messages
  std::uint64_t end_time_ns = 0;
  std::uint64_t plain_size = 0;  // of the records once decompressed
  std::uint32_t plain_crc = 0;   // 0: not given
  std::string compression{};
  ByteView records{};  // as stored
};

struct MessageIndex {
  struct Entry {
    std::uint64_t log_time_ns;
    std::uint64_t offset;  // of the Message record in the decompressed chunk
    bool operator==(const Entry&) const = default;
  };
  ChannelId channel_id{};
  std::vector<Entry> entries{};
};

struct ChunkIndex {
  std::uint64_t start_time_ns = 0;
  std::uint64_t end_time_ns = 0;
  std::uint64_t chunk_offset = 0;
  std::uint64_t chunk_length = 0;  // of the whole Chunk record
  std::vector<std::pair<ChannelId, std::uint64_t>> message_index_offsets{};
  std::uint64_t message_index_length = 0;
  std::string compression{};
  std::uint64_t packed_size = 0;
  std::uint64_t plain_size = 0;
};

struct Attachment {
  std::uint64_t log_time_ns = 0;
  std::uint64_t create_time_ns = 0;  // 0: not known
  std::string name{};
  std::string media_type{};
  ByteView data{};
};

struct AttachmentIndex {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  // of the whole Attachment record
  std::uint64_t log_time_ns = 0;
  std::uint64_t create_time_ns = 0;
  std::uint64_t data_size = 0;
  std::string name{};
  std::string media_type{};
};

struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t start_time_ns = 0;  // earliest and latest log time; both 0 without messages
  std::uint64_t end_time_ns = 0;
  std::map<ChannelId, std::uint64_t> channel_message_counts{};
};

struct Metadata {
  std::string name{};
  StringMap values{};
};

struct MetadataIndex {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  // of the whole Metadata record
  std::string name{};
};

struct SummaryOffset {
  Opcode group{};
  std::uint64_t group_start = 0;
  std::uint64_t group_length = 0;
};

struct DataEnd {
  std::uint32_t data_crc = 0;  // of the file up to this record; 0: not given
};

void appendHeader(Bytes& out, const Header& header);
void appendFooter(Bytes& out, const Footer& footer);
void appendSchema(Bytes& out, const Schema& schema);
void appendChannel(Bytes& out, const Channel& channel);
void appendMessage(Bytes& out, const Message& message);
/// All but the records, which are to follow.
void appendChunkHead(Bytes& out, const Chunk& chunk);
void appendMessageIndex(Bytes& out, const MessageIndex& index);
void appendChunkIndex(Bytes& out, const ChunkIndex& index);
/// All but the data and the CRC (u32, of the body before it), which are to follow.
void appendAttachmentHead(Bytes& out, const Attachment& attachment);
void appendAttachmentIndex(Bytes& out, const AttachmentIndex& index);
void appendStatistics(Bytes& out, const Statistics& statistics);
void appendMetadata(Bytes& out, const Metadata& metadata);
void appendMetadataIndex(Bytes& out, const MetadataIndex& index);
void appendSummaryOffset(Bytes& out, const SummaryOffset& offset);
void appendDataEnd(Bytes& out, const DataEnd& data_end);

[[nodiscard]] Header decodeHeader(ByteView body);
[[nodiscard]] Footer decodeFooter(ByteView body);
[[nodiscard]] Schema decodeSchema(ByteView body);
[[nodiscard]] Channel decodeChannel(ByteView body);
[[nodiscard]] Message decodeMessage(ByteView body);
[[nodiscard]] Chunk decodeChunk(ByteView body);
[[nodiscard]] MessageIndex decodeMessageIndex(ByteView body);
[[nodiscard]] ChunkIndex decodeChunkIndex(ByteView body);
/// The fields in front of the data, which need not be in `body`: an attachment may be larger than memory.
struct AttachmentHead {
  Attachment fields;            // without data
  std::uint64_t data_offset{};  // in the body
  std::uint64_t data_size{};
};
[[nodiscard]] AttachmentHead decodeAttachmentHead(ByteView body);
[[nodiscard]] AttachmentIndex decodeAttachmentIndex(ByteView body);
[[nodiscard]] Statistics decodeStatistics(ByteView body);
[[nodiscard]] Metadata decodeMetadata(ByteView body);
[[nodiscard]] MetadataIndex decodeMetadataIndex(ByteView body);
[[nodiscard]] SummaryOffset decodeSummaryOffset(ByteView body);
[[nodiscard]] DataEnd decodeDataEnd(ByteView body);

/// One record in a view of several.
struct RecordView {
  Opcode opcode{};
  ByteView body{};
};
/// Takes the next record off `in`; nothing at its end. Throws FormatError when the record does not fit, or where zeros
/// are in the place of one.
[[nodiscard]] std::optional<RecordView> nextRecord(ByteReader& in);

}  // namespace baton::mcap
