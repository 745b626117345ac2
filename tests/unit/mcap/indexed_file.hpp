/// A finished file made by hand, whose index can be made to say what its data do not.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "recording.hpp"

namespace baton::mcap {

/// Every record but messages and the footer ends with `extra`, as a later version of the format may have it.
class IndexedFile {
 public:
  explicit IndexedFile(Bytes extra_bytes = {}) : extra(std::move(extra_bytes)) {
    append(data, kMagic);
    put(data, appendHeader, {.profile = "", .library = "builder"});
  }

  /// To be declared in the next chunk, and in the summary.
  void schema(const Schema& one) {
    put(records, appendSchema, one);
    if (statistics.schema_count++ == 0 || schemas.back().id != one.id) schemas.push_back(one);
  }
  void channel(const Channel& one) {
    put(records, appendChannel, one);
    for (const Channel& known : channels) {
      if (known.id == one.id) return;
    }
    channels.push_back(one);
  }
  void message(std::uint16_t channel, std::uint64_t time_ns) {
    entries[ChannelId{channel}].push_back({.log_time_ns = time_ns, .offset = records.size()});
    appendMessage(records, {.channel_id = ChannelId{channel}, .sequence = sequence++, .log_time_ns = time_ns});
  }
  void closeChunk() {
    ChunkIndex index{.chunk_offset = data.size(), .packed_size = records.size(), .plain_size = records.size()};
    bool is_first = true;
    for (const auto& [id, of_channel] : entries) {
      for (const MessageIndex::Entry& entry : of_channel) {
        index.start_time_ns = is_first ? entry.log_time_ns : std::min(index.start_time_ns, entry.log_time_ns);
        index.end_time_ns = std::max(index.end_time_ns, entry.log_time_ns);
        is_first = false;
      }
      statistics.channel_message_counts[id] += of_channel.size();
      statistics.message_count += of_channel.size();
    }
    Chunk head{.start_time_ns = index.start_time_ns, .end_time_ns = index.end_time_ns};
    change_head(head);
    Bytes chunk;
    appendChunkHead(chunk, {.start_time_ns = head.start_time_ns,
                            .end_time_ns = head.end_time_ns,
                            .plain_size = records.size(),
                            .plain_crc = crcByBits(records),
                            .records = records});
    append(chunk, records);
    put(data, chunk);
    index.chunk_length = data.size() - index.chunk_offset;
    for (const auto& [id, of_channel] : entries) {
      MessageIndex messages{.channel_id = id, .entries = of_channel};
      if (!change_message_index(messages)) continue;
      index.message_index_offsets.emplace_back(id, data.size());
      put(data, appendMessageIndex, messages);
    }
    index.message_index_length = data.size() - index.chunk_offset - index.chunk_length;
    chunks.push_back(index);
    records.clear();
    entries.clear();
  }
  void attachment(const std::string& name, std::string_view text) {
    const Attachment one{.name = name, .media_type = "text/plain", .data = asBytes(text)};
    Bytes record;
    appendAttachmentHead(record, one);
    append(record, one.data);
    appendNumber(record, crcByBits(ByteView(record).subspan(kRecordHeadBytes)));
    const std::size_t offset = data.size();
    put(data, record);
    attachments.push_back({.offset = offset,
                           .length = data.size() - offset,
                           .data_size = text.size(),
                           .name = name,
                           .media_type = one.media_type});
  }
  void addMetadata(const std::string& name) {
    const std::size_t offset = data.size();
    put(data, appendMetadata, {.name = name, .values = {{"k", "v"}}});
    metadata.push_back({.offset = offset, .length = data.size() - offset, .name = name});
  }

  /// As it is without its summary: cut off.
  [[nodiscard]] const Bytes& cut() const { return data; }
  [[nodiscard]] Bytes finished() {
    statistics.schema_count = static_cast<std::uint16_t>(schemas.size());
    statistics.channel_count = static_cast<std::uint32_t>(channels.size());
    statistics.chunk_count = static_cast<std::uint32_t>(chunks.size());
    statistics.attachment_count = static_cast<std::uint32_t>(attachments.size());
    statistics.metadata_count = static_cast<std::uint32_t>(metadata.size());
    for (const ChunkIndex& chunk : chunks) {
      const bool is_first = &chunk == &chunks.front();
      statistics.start_time_ns =
          is_first ? chunk.start_time_ns : std::min(statistics.start_time_ns, chunk.start_time_ns);
      statistics.end_time_ns = std::max(statistics.end_time_ns, chunk.end_time_ns);
    }
    change_summary(*this);
    Bytes file = data;
    put(file, appendDataEnd, {});
    const std::size_t summary_start = file.size();
    for (const Schema& one : schemas) put(file, appendSchema, one);
    for (const Channel& one : channels) put(file, appendChannel, one);
    SummaryOffset offset{.group = Opcode::kStatistics, .group_start = file.size()};
    put(file, appendStatistics, statistics);
    offset.group_length = file.size() - offset.group_start;
    for (const ChunkIndex& one : chunks) put(file, appendChunkIndex, one);
    for (const AttachmentIndex& one : attachments) put(file, appendAttachmentIndex, one);
    for (const MetadataIndex& one : metadata) put(file, appendMetadataIndex, one);
    Footer footer{.summary_start = summary_start, .summary_offset_start = file.size()};
    change_offsets(offset, footer);
    put(file, appendSummaryOffset, offset);
    appendFooter(file, footer);
    append(file, kMagic);
    return file;
  }

  Bytes extra;
  Bytes data;
  Bytes records;  // of the next chunk
  std::map<ChannelId, std::vector<MessageIndex::Entry>> entries;
  std::uint32_t sequence = 0;
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  Statistics statistics;
  std::vector<ChunkIndex> chunks;
  std::vector<AttachmentIndex> attachments;
  std::vector<MetadataIndex> metadata;
  std::function<void(Chunk&)> change_head = [](Chunk&) {};
  std::function<bool(MessageIndex&)> change_message_index = [](MessageIndex&) { return true; };  // false: leave it out
  std::function<void(IndexedFile&)> change_summary = [](IndexedFile&) {};
  std::function<void(SummaryOffset&, Footer&)> change_offsets = [](SummaryOffset&, Footer&) {};

 private:
  template <class Record>
  void put(Bytes& out, void (*append_record)(Bytes&, const Record&), const std::type_identity_t<Record>& one) const {
    Bytes record;
    append_record(record, one);
    put(out, record);
  }
  void put(Bytes& out, Bytes record) const {
    const std::uint64_t length = record.size() - kRecordHeadBytes + extra.size();
    std::memcpy(record.data() + 1, &length, sizeof length);
    append(out, record);
    append(out, extra);
  }
};

}  // namespace baton::mcap
