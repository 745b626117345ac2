/// Writes a recording: an indexed, chunked MCAP file whose every byte is checked on its way to the operating system.
///
/// Messages gather in a chunk; a full chunk is compressed, given a CRC, indexed and handed over in one go. What a
/// process killed at any instant leaves behind is readable up to its last whole chunk, because schemas and channels go
/// into the data before their first message as well as into the summary at the end. Each chunk declares the channels
/// it has messages of, and their schemas: no chunk needs another, so a damaged one costs what is in it and no more.
/// With chunks of 256 KiB that is 3 to 4 % of the file of a short run. Nothing is allocated per message or per chunk
/// once the buffers have grown, but for one index entry a chunk.
///
/// One thread at a time. The bytes depend on the calls only: no clock, no random number.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mcap/compression.hpp"
#include "mcap/file.hpp"
#include "mcap/records.hpp"

namespace baton::mcap {

/// The largest chunk written, so that any reader can hold one in memory.
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 30;

struct WriterOptions {
  std::string profile;            // "": no requirements beyond the specification
  std::string library = "baton";  // who wrote the file, with its version
  Compression compression = Compression::kZstd;
  int compression_level = 1;  // see Compressor; zstd 3 makes a run's file 3 % smaller, in half as long again
  // A chunk is closed before it grows above this, not counting declarations it repeats; a larger message gets its own.
  std::size_t chunk_bytes = 1U << 20;
  bool has_crc = true;        // CRCs of chunks, attachments, data section and summary
  bool sync_chunks = false;   // each chunk waits for the storage device
  bool sync_on_close = true;  // close() waits for the storage device
  OutputFile::IfExists if_exists = OutputFile::IfExists::kRefuse;
};

struct WriterStatistics {
  std::uint64_t messages = 0;          // accepted by write()
  std::uint64_t message_bytes = 0;     // their payloads
  std::uint64_t written_messages = 0;  // of these, in chunks the operating system has taken
  std::uint64_t chunks = 0;            // taken by the operating system
  std::uint64_t file_bytes = 0;        // taken by the operating system
  std::uint64_t durable_bytes = 0;     // known to be on the storage device
  std::uint64_t declared_bytes = 0;    // of all schemas and channels: a chunk may repeat them, and the summary does
};

/// After a WriteError every call but the destructor throws that same error again: the file ends where it failed.
class Writer {
 public:
  /// Creates the file and writes its header. Throws UnavailableError when the file is there already (unless if_exists
  /// says otherwise) or cannot be created, UsageError for an option out of range.
  explicit Writer(const std::filesystem::path& path, WriterOptions options = {});
  /// Closes without throwing: call close() to know that it went well.
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// The id of this schema, the same for the same schema. Baton uses name "baton::msg::Type", encoding "omgidl", and
  /// the self-contained IDL text. Throws UsageError beyond 65535 schemas.
  SchemaId addSchema(std::string_view name, std::string_view encoding, ByteView data);

  /// A new channel, with its own counts; two channels may share a topic. Throws UsageError for a schema that was not
  /// added (kNoSchema is allowed) and beyond 65535 channels.
  ChannelId addChannel(std::string_view topic, std::string_view message_encoding, SchemaId schema_id,
                       const StringMap& metadata = {});

  /// @param sequence  the publisher's message counter.
  /// @param log_time_ns  when it was recorded; never decreasing from call to call, or readers must sort.
  /// @param publish_time_ns  when it was published, log_time_ns when that is not known.
  /// Throws UsageError for a channel that was not added and for a message that does not fit kMaxChunkBytes.
  void write(ChannelId channel, std::uint32_t sequence, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
             ByteView data);

  /// Goes into the file when the current chunk is closed, so that it does not cut chunks short.
  void addMetadata(std::string_view name, const StringMap& values);

  /// Closes the current chunk and goes into the file at once.
  /// @param create_time_ns  0 when not known.
  void addAttachment(std::string_view name, std::string_view media_type, std::uint64_t log_time_ns,
                     std::uint64_t create_time_ns, ByteView data);

  /// Closes the current chunk and hands everything to the operating system: it survives the end of this process.
  void flush();
  /// Flushes and waits for the storage device: it survives the end of the machine.
  void sync();
  /// Writes the summary and closes. Calling it again does nothing.
  void close();
  /// Takes the file away: a recording that is not to be finished. Nothing can be done with it any more.
  void discard() noexcept;

  [[nodiscard]] WriterStatistics statistics() const;

 private:
  struct SchemaState {
    Schema schema;
    Bytes record{};
    std::uint64_t declared_in = 0;  // the last chunk that has the record
  };
  struct ChannelState {
    Channel channel;
    Bytes record{};
    std::uint64_t declared_in = 0;
    MessageIndex index{};  // of the current chunk
    std::uint64_t count = 0;
  };

  [[nodiscard]] std::size_t declarationBytes(const ChannelState& state) const;
  void declare(ChannelState& state);
  void makeRoom(std::size_t record_bytes, std::size_t declaration_bytes = 0);
  void closeChunk();
  void writeChunk();
  void writePending();
  void writeSummary();
  void emit(ByteView bytes);

  WriterOptions options_;
  Compressor compressor_;
  OutputFile file_;
  bool is_closed_ = false;
  std::uint32_t data_crc_ = 0;

  std::vector<SchemaState> schemas_;       // [id - 1]
  std::map<std::string, SchemaId> known_;  // of them, by all but their number
  std::vector<ChannelState> channels_;     // [id - 1]
  std::vector<ChunkIndex> chunk_indexes_;
  std::vector<AttachmentIndex> attachment_indexes_;
  std::vector<MetadataIndex> metadata_indexes_;
  std::uint64_t messages_ = 0;
  std::uint64_t message_bytes_ = 0;
  std::uint64_t written_messages_ = 0;
  std::uint64_t start_time_ns_ = 0;
  std::uint64_t end_time_ns_ = 0;

  Bytes chunk_;  // records of the current chunk
  std::uint64_t chunk_number_ = 1;
  std::uint64_t declared_bytes_ = 0;
  std::size_t repeated_bytes_ = 0;  // declarations in the current chunk that an earlier one has too
  std::uint64_t chunk_messages_ = 0;
  std::uint64_t chunk_start_time_ns_ = 0;
  std::uint64_t chunk_end_time_ns_ = 0;
  std::vector<ChannelId> chunk_channels_;       // with a message in the current chunk, in order of appearance
  Bytes pending_;                               // Metadata records that wait for the current chunk
  std::vector<MetadataIndex> pending_indexes_;  // their offsets within pending_
  Bytes scratch_;
};

}  // namespace baton::mcap
