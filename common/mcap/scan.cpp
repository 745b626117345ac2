/// Indexing by reading a recording from its start: for a file that was cut off, or that has no summary to trust.
#include <algorithm>
#include <utility>

#include "mcap/extent.hpp"
#include "mcap/index.hpp"

namespace baton::mcap {
namespace {

/// Consecutive records outside of chunks are taken together up to this size, so that a file without chunks is read in
/// pieces that fit memory.
constexpr std::uint64_t kRunBytes = 4 << 20;
/// The fields in front of an attachment's data are looked for in its first bytes only: its data can be of any size.
constexpr std::uint64_t kAttachmentHeadBytes = 1 << 20;

/// What a DataEnd holds; another length is another record with a damaged opcode.
constexpr std::uint64_t kDataEndBytes = 4;

class Scan {
 public:
  Scan(const InputFile& file, const ReaderOptions& options) : file_(file), options_(options), loader_(file, options) {}

  FileIndex run() {
    index_.info.file_bytes = file_.size();
    RecordWalk walk(file_, kMagic.size(), file_.size());
    bool is_first = true;
    bool is_data = true;
    while (true) {
      const std::optional<RecordPlace> place = walk.next();
      if (is_data && goOnBehindDamage(walk, place)) continue;
      if (!place) break;
      if (std::exchange(is_first, false) && takeHeader(*place)) continue;
      if (place->opcode == Opcode::kFooter) {
        closeRun();
        closeFile(*place);
        return finish();
      }
      if (is_data) {
        take(*place);
        is_data = place->opcode != Opcode::kDataEnd || place->body_length != kDataEndBytes;
        index_.info.has_all_data = !is_data;
      }
    }
    closeRun();
    index_.info.complete_bytes = walk.position();
    index_.info.problem =
        "cut at " +
        (walk.problem().empty() ? "byte " + std::to_string(walk.position()) + ": no footer follows" : walk.problem());
    return finish();
  }

 private:
  /// False when the file goes on as if it had none, and the caller wants what is left of it.
  bool takeHeader(const RecordPlace& place) {
    if (place.opcode == Opcode::kHeader) {
      guarded(place, [&](ByteView body) { index_.info.header = decodeHeader(body); });
      return true;
    }
    const std::string what = "it begins with " + opcodeName(place.opcode) + " where a Header is required";
    if (!options_.on_damage) throw FormatError(file_.path().string() + " is not an MCAP recording: " + what);
    options_.on_damage({place.offset, 0, what});
    return false;
  }

  /// decode(body) of a record outside of chunks, unless it is damaged and left out.
  template <class Decode>
  void guarded(const RecordPlace& place, Decode decode) {
    const Extent extent{.offset = place.offset, .length = place.length(), .is_chunk = false};
    (void)loader_.guarded(extent, [&] { decode(readBody(file_, place, options_, storage_)); });
  }

  /// Where the records cannot be followed any more, because none is there or because a chunk's own lengths disagree, a
  /// caller who wants what is left gets what follows from the next chunk on. False when all is well or nothing follows.
  bool goOnBehindDamage(RecordWalk& walk, const std::optional<RecordPlace>& place) {
    const bool is_torn =
        place ? place->opcode == Opcode::kChunk && !looksLikeChunk(place->offset) : !walk.problem().empty();
    if (!options_.on_damage || !is_torn) return false;
    const std::uint64_t from = place ? place->offset : walk.position();
    const std::optional<std::uint64_t> next = nextChunk(from + 1);
    if (!next) return false;
    closeRun();
    options_.on_damage({from, *next - from, place ? "the lengths of the chunk disagree" : walk.problem()});
    walk.moveTo(*next);
    return true;
  }

  /// Whether a chunk begins there, judging by its lengths, which have to fit one another.
  [[nodiscard]] bool looksLikeChunk(std::uint64_t offset) const {
    constexpr std::uint64_t kFixedBytes = kRecordHeadBytes + 8 + 8 + 8 + 4;  // up to the name of the compression
    std::array<std::byte, kFixedBytes + 4 + 4 + 8> head{};                   // of which the longest has four letters
    const std::uint64_t left = file_.size() - offset;
    file_.read(offset, std::span(head).first(static_cast<std::size_t>(std::min<std::uint64_t>(left, head.size()))));
    try {
      ByteReader in(head);
      if (Opcode{in.number<std::uint8_t>()} != Opcode::kChunk) return false;
      const auto length = in.number<std::uint64_t>();
      (void)in.bytes(kFixedBytes - kRecordHeadBytes);
      const std::string compression = in.string();
      (void)compressionFromName(compression);
      const std::uint64_t fields = kFixedBytes - kRecordHeadBytes + 4 + compression.size() + 8;
      return length <= left - kRecordHeadBytes && length >= fields && in.number<std::uint64_t>() == length - fields;
    } catch (const FormatError&) {
      return false;
    }
  }

  [[nodiscard]] std::optional<std::uint64_t> nextChunk(std::uint64_t from) {
    for (; from + kRecordHeadBytes < file_.size(); from += kRunBytes) {
      const std::span<std::byte> window =
          storage_.resize(static_cast<std::size_t>(std::min(kRunBytes, file_.size() - from)));
      file_.read(from, window);
      for (auto at = window.begin(); (at = std::find(at, window.end(), std::byte{0x06})) != window.end(); ++at) {
        const std::uint64_t offset = from + static_cast<std::uint64_t>(at - window.begin());
        if (offset + kRecordHeadBytes < file_.size() && looksLikeChunk(offset)) return offset;
      }
    }
    return std::nullopt;
  }

  void take(const RecordPlace& place) {
    const bool belongs_to_run =
        place.opcode == Opcode::kSchema || place.opcode == Opcode::kChannel || place.opcode == Opcode::kMessage;
    if (!belongs_to_run || run_.length + place.length() > kRunBytes) closeRun();
    if (belongs_to_run) {
      if (run_.length == 0) run_.offset = place.offset;
      run_.length += place.length();
    } else if (place.opcode == Opcode::kChunk) {
      ++index_.statistics.chunk_count;
      takeExtent({.offset = place.offset, .length = place.length()});
    } else if (place.opcode == Opcode::kAttachment) {
      takeAttachment(place);
    } else if (place.opcode == Opcode::kMetadata) {
      guarded(place, [&](ByteView body) {
        Metadata metadata = decodeMetadata(body);
        index_.metadata.push_back({.offset = place.offset, .length = place.length(), .name = std::move(metadata.name)});
      });
    }
  }

  void takeAttachment(const RecordPlace& place) {
    // Enough for the head; the data after it are bounded by the record's own length.
    RecordPlace front = place;
    front.body_length = std::min(place.body_length, kAttachmentHeadBytes);
    guarded(front, [&](ByteView body) {
      AttachmentHead head = decodeAttachmentHead(body);
      index_.attachments.push_back({.offset = place.offset,
                                    .length = place.length(),
                                    .log_time_ns = head.fields.log_time_ns,
                                    .create_time_ns = head.fields.create_time_ns,
                                    .data_size = head.data_size,
                                    .name = std::move(head.fields.name),
                                    .media_type = std::move(head.fields.media_type)});
    });
  }

  void closeRun() {
    const Extent run = std::exchange(run_, {.is_chunk = false});
    if (run.length > 0) takeExtent(run);
  }

  /// Learns the schemas and channels of an extent and counts its messages: all of them or, when it is damaged, none.
  void takeExtent(Extent extent) {
    if (options_.on_progress) options_.on_progress(extent.offset, file_.size());
    std::map<ChannelId, std::uint64_t> counts;
    const bool is_sound = loader_.guarded(extent, [&] {
      ByteReader in(loader_.load(extent, storage_));
      while (const std::optional<RecordView> record = nextRecord(in)) {
        if (record->opcode == Opcode::kSchema) {
          takeSchema(decodeSchema(record->body));
        } else if (record->opcode == Opcode::kChannel) {
          takeChannel(decodeChannel(record->body));
        } else if (record->opcode == Opcode::kMessage) {
          const Message message = decodeMessage(record->body);
          if (!index_.channels.contains(message.channel_id)) {
            throw FormatError("a message belongs to channel " +
                              std::to_string(static_cast<unsigned>(message.channel_id)) + ", which is not known");
          }
          const bool is_first = counts.empty();
          extent.start_time_ns = is_first ? message.log_time_ns : std::min(extent.start_time_ns, message.log_time_ns);
          extent.end_time_ns = is_first ? message.log_time_ns : std::max(extent.end_time_ns, message.log_time_ns);
          ++counts[message.channel_id];
        }
      }
    });
    if (!is_sound || counts.empty()) return;
    Statistics& statistics = index_.statistics;
    const bool is_first = index_.extents.empty();
    statistics.start_time_ns =
        is_first ? extent.start_time_ns : std::min(statistics.start_time_ns, extent.start_time_ns);
    statistics.end_time_ns = std::max(statistics.end_time_ns, extent.end_time_ns);
    for (const auto& [id, count] : counts) {
      statistics.channel_message_counts[id] += count;
      statistics.message_count += count;
      extent.channels.push_back(id);
    }
    index_.extents.push_back(std::move(extent));
  }

  void takeSchema(Schema schema) {
    if (schema.id == kNoSchema) return;  // invalid, and to be ignored
    const auto [known, is_new] = index_.schemas.try_emplace(schema.id, schema);
    if (!is_new && known->second != schema) {
      throw FormatError("schema " + std::to_string(static_cast<unsigned>(schema.id)) + " is given twice and differs");
    }
  }

  void takeChannel(Channel channel) {
    const auto [known, is_new] = index_.channels.try_emplace(channel.id, channel);
    if (!is_new && known->second != channel) {
      throw FormatError("channel " + std::to_string(static_cast<unsigned>(channel.id)) + " is given twice and differs");
    }
  }

  /// A finished recording ends with the magic behind its footer.
  void closeFile(const RecordPlace& footer) {
    FileInfo& info = index_.info;
    const std::uint64_t left = file_.size() - footer.end();
    std::array<std::byte, kMagic.size()> magic{};
    if (left >= magic.size()) file_.read(footer.end(), magic);
    if (magic != kMagic) {
      info.complete_bytes = footer.end();
      info.problem = "cut at byte " + std::to_string(footer.end()) + ": the closing magic does not follow the footer";
      return;
    }
    info.complete_bytes = footer.end() + magic.size();
    info.is_complete = info.complete_bytes == file_.size();
    if (!info.is_complete) {
      info.problem = std::to_string(left - magic.size()) + " bytes follow the end of the recording at byte " +
                     std::to_string(info.complete_bytes);
    }
  }

  FileIndex finish() {
    Statistics& statistics = index_.statistics;
    statistics.schema_count = static_cast<std::uint16_t>(index_.schemas.size());
    statistics.channel_count = static_cast<std::uint32_t>(index_.channels.size());
    statistics.attachment_count = static_cast<std::uint32_t>(index_.attachments.size());
    statistics.metadata_count = static_cast<std::uint32_t>(index_.metadata.size());
    return std::move(index_);
  }

  const InputFile& file_;
  const ReaderOptions& options_;
  ExtentLoader loader_;
  Buffer storage_;
  FileIndex index_;
  Extent run_{.is_chunk = false};  // consecutive records outside of chunks; empty when length is 0
};

}  // namespace

FileIndex scanFile(const InputFile& file, const ReaderOptions& options) { return Scan(file, options).run(); }

}  // namespace baton::mcap
