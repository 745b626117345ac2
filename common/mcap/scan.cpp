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
/// Where to go on behind damage is looked for in pieces that grow from this up to kRunBytes: it may be near, often.
constexpr std::uint64_t kSearchBytes = 4 << 10;

/// A number in the file; 0 behind its end.
template <std::unsigned_integral Number>
std::uint64_t numberAt(const InputFile& file, std::uint64_t offset) {
  Number value = 0;
  if (offset <= file.size() && sizeof value <= file.size() - offset) {
    file.read(offset, std::as_writable_bytes(std::span(&value, 1)));
  }
  return value;
}

/// Whether the lengths in the record there fit one another, for the kinds that have several. That is more than chance
/// gives, so it also tells such a record from other bytes.
bool fits(const InputFile& file, const RecordPlace& place) {
  const std::uint64_t body = place.offset + kRecordHeadBytes;
  switch (place.opcode) {
    case Opcode::kChunk: {
      constexpr std::uint64_t kNameAt = 8 + 8 + 8 + 4, kLongestName = 4;
      const std::uint64_t name = numberAt<std::uint32_t>(file, body + kNameAt);
      if (name > kLongestName || place.body_length < kNameAt + 4 + name + 8) return false;
      return numberAt<std::uint64_t>(file, body + kNameAt + 4 + name) == place.body_length - (kNameAt + 4 + name + 8);
    }
    case Opcode::kMessageIndex: {
      constexpr std::uint64_t kEntryBytes = 8 + 8;
      const std::uint64_t entries = numberAt<std::uint32_t>(file, body + 2);
      return entries % kEntryBytes == 0 && place.body_length == 2 + 4 + entries;
    }
    case Opcode::kAttachment: {
      constexpr std::uint64_t kNameAt = 8 + 8, kFixedBytes = kNameAt + 4 + 4 + 8 + 4;
      const std::uint64_t name = numberAt<std::uint32_t>(file, body + kNameAt);
      const std::uint64_t media = numberAt<std::uint32_t>(file, body + kNameAt + 4 + name);
      const std::uint64_t known = kFixedBytes + name + media;
      if (place.body_length < known) return false;
      return numberAt<std::uint64_t>(file, body + kNameAt + 4 + name + 4 + media) == place.body_length - known;
    }
    default: return true;
  }
}

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

  /// Where the records cannot be followed any more, because none is there or because the lengths in one disagree, a
  /// caller who wants what is left gets what follows from the next chunk or attachment on. False when all is well or
  /// nothing follows.
  bool goOnBehindDamage(RecordWalk& walk, const std::optional<RecordPlace>& place) {
    const bool is_torn = place ? !fits(file_, *place) : !walk.problem().empty();
    if (!options_.on_damage || !is_torn) return false;
    const std::uint64_t from = place ? place->offset : walk.position();
    const std::optional<std::uint64_t> next = searchFrom(from + 1);
    if (!next) return false;
    closeRun();
    options_.on_damage(
        {from, *next - from, place ? "the lengths of the " + opcodeName(place->opcode) + " disagree" : walk.problem()});
    walk.moveTo(*next);
    return true;
  }

  /// Where the next chunk or attachment begins. A recording that is attached to this one has chunks that are not of
  /// this one: attachments are found whole, and of one whose own beginning is damaged the magic tells.
  [[nodiscard]] std::optional<std::uint64_t> searchFrom(std::uint64_t from) {
    bool is_inside = false;  // of a recording in an attachment
    std::uint64_t size = kSearchBytes;
    for (; from + kRecordHeadBytes < file_.size(); from += size, size = std::min(2 * size, kRunBytes)) {
      // Records that begin in this piece are looked at whole, and so is a magic: it ends behind it.
      const std::span<std::byte> window =
          storage_.resize(static_cast<std::size_t>(std::min(size + kMagic.size() - 1, file_.size() - from)));
      file_.read(from, window);
      for (std::size_t i = 0; i < std::min<std::uint64_t>(size, window.size()); ++i) {
        if (std::ranges::equal(ByteView(window).subspan(i).first(std::min(kMagic.size(), window.size() - i)), kMagic)) {
          is_inside = !is_inside;
        }
        const auto opcode = Opcode{std::to_integer<std::uint8_t>(window[i])};
        if (is_inside || (opcode != Opcode::kChunk && opcode != Opcode::kAttachment)) continue;
        const RecordPlace place{
            .opcode = opcode, .offset = from + i, .body_length = numberAt<std::uint64_t>(file_, from + i + 1)};
        if (place.body_length < file_.size() && place.end() <= file_.size() && fits(file_, place)) return place.offset;
      }
    }
    return std::nullopt;
  }

  void take(const RecordPlace& place) {
    noteHiddenChunk(place);
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

  /// The messages of a chunk are indexed right behind it. Where an index follows a record of a kind that nobody knows,
  /// that was a chunk before its first byte changed.
  void noteHiddenChunk(const RecordPlace& place) {
    if (place.opcode != Opcode::kMessageIndex) {
      const bool is_known = place.opcode <= Opcode::kDataEnd;
      hidden_ = is_known || previous_ == Opcode::kChunk ? std::nullopt : std::optional(place);
    } else if (hidden_ && options_.on_damage) {
      options_.on_damage({hidden_->offset, hidden_->length(), "it is indexed as a chunk, and is of no known kind"});
      hidden_.reset();
    }
    previous_ = place.opcode;
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
  Opcode previous_{};                  // of the record before
  std::optional<RecordPlace> hidden_;  // a record that may have been a chunk
  Extent run_{.is_chunk = false};      // consecutive records outside of chunks; empty when length is 0
};

}  // namespace

FileIndex scanFile(const InputFile& file, const ReaderOptions& options) { return Scan(file, options).run(); }

}  // namespace baton::mcap
