/// Indexing by reading a recording from its start: for a file that was cut off, or that has no summary to trust.
#include <algorithm>
#include <utility>

#include "mcap/contents.hpp"
#include "mcap/extent.hpp"
#include "mcap/foreign.hpp"
#include "mcap/index.hpp"
#include "mcap/search.hpp"
#include "mcap/shape.hpp"

namespace baton::mcap {
namespace {

/// Consecutive records outside of chunks are taken together up to this size, so that a file without chunks is read in
/// pieces that fit memory.
constexpr std::uint64_t kRunBytes = 4 << 20;
/// The fields in front of an attachment's data are looked for in its first bytes only: its data can be of any size.
constexpr std::uint64_t kAttachmentHeadBytes = 1 << 20;

/// Contradictions and cuts that are named one by one: a file can have any number.
constexpr std::size_t kMostNoted = 20;
/// Records are searched for another recording in a file with fewer.
constexpr std::size_t kMostJoined = 100;

class Scan {
 public:
  Scan(const InputFile& file, const ReaderOptions& options, const FileIndex* summary)
      : file_(file), options_(options), loader_(file, options), search_(file), declarations_(index_, summary) {
    index_.info.file_bytes = file.size();
  }

  /// @param begin  of the first recording.
  FileIndex run(std::uint64_t begin) {
    index_.info.beginnings = {begin};
    if (begin > 0) index_.info.foreign.push_back(foreignBytes(file_, 0, begin));
    if (!hasMagic(file_, begin)) contradict("it begins with a Header, and with other bytes than the magic before it");
    RecordWalk walk(file_, begin + kMagic.size(), file_.size());
    while (true) {
      const std::optional<RecordPlace> place = walk.next();
      if (!place && goOnWithNextRecording(walk, walk.position())) continue;
      if (goOnBehindDamage(walk, place)) continue;
      if (!place) break;
      if (std::exchange(is_first_, false) && takeHeader(*place)) continue;
      if (place->opcode == Opcode::kFooter) {
        settle();
        closeFile(*place);
        if (goOnBehindEnd(walk)) continue;
        return finish();
      }
      if (is_data_) {
        take(*place);
        is_data_ = !isDataEnd(*place);
        data_end_ = place->end();
        index_.info.has_all_data = !is_data_;
        if (torn_into_) walk.moveTo(*std::exchange(torn_into_, std::nullopt));
      } else {
        refuseMisplaced(*place);
      }
    }
    settle();
    index_.info.complete_bytes = walk.position();
    index_.info.problem =
        "cut at " +
        (walk.problem().empty() ? "byte " + std::to_string(walk.position()) + ": no footer follows" : walk.problem());
    return finish();
  }

 private:
  /// Recordings that were joined end to end: the next one begins there. Its ids are its own.
  bool goOnWithNextRecording(RecordWalk& walk, std::uint64_t at) {
    if (!beginsRecording(file_, at)) return false;
    settle();
    if (!std::exchange(is_closed_, false)) noteCut(at);
    index_.info.beginnings.push_back(at);
    index_.info.has_all_data = false;
    noteSchemas();
    contradict("another recording begins at byte " + std::to_string(at) +
               ", as when files are joined with `cat`: `bag merge` makes one recording of several");
    declarations_.forget();
    is_first_ = is_data_ = true;
    previous_ = {};
    hidden_.reset();
    walk.moveTo(at + kMagic.size());
    return true;
  }

  /// Behind a footer. What lies between two recordings, as where the first was padded, is of neither.
  bool goOnBehindEnd(RecordWalk& walk) {
    const std::uint64_t end = index_.info.complete_bytes, longest_cut = is_closed_ ? 0 : kMagic.size();
    if (goOnWithNextRecording(walk, end)) return true;
    const std::optional<std::uint64_t> next = search_.recordingIn(end, file_.size());
    const std::uint64_t between = next.value_or(file_.size()) - end;
    if (between > longest_cut) index_.info.foreign.push_back(foreignBytes(file_, end, between));
    return next && goOnWithNextRecording(walk, *next);
  }

  /// Of a recording that another one follows.
  void noteCut(std::uint64_t at) {
    const std::string cut =
        "the recording that another one follows at byte " + std::to_string(at) + " is cut: it has no end";
    std::vector<Damage>& cuts = index_.info.cuts;
    if (is_data_ && cuts.size() < kMostNoted) cuts.push_back({.offset = at, .reason = cut});
    if (!cut_.empty()) return;
    cut_ = cut;
    cut_at_ = at;
  }

  /// What a DataEnd is followed by distinguishes one with added fields from another record with a damaged opcode.
  [[nodiscard]] bool isDataEnd(const RecordPlace& place) const {
    const std::uint64_t least = leastBytes(Opcode::kDataEnd);
    if (place.opcode != Opcode::kDataEnd || place.body_length <= least) {
      return place.opcode == Opcode::kDataEnd && place.body_length == least;
    }
    return beginsIndex(file_, place.end());
  }

  /// Data after the end of the data are in no index, and nothing says whether they belong there.
  void refuseMisplaced(const RecordPlace& place) {
    if (place.opcode != Opcode::kMessage && place.opcode != Opcode::kChunk && place.opcode != Opcode::kAttachment)
      return;
    const Extent extent{.offset = place.offset, .length = place.length(), .is_chunk = place.opcode == Opcode::kChunk};
    (void)loader_.guarded(extent, [&]() -> void {
      throw FormatError("it is a " + opcodeName(place.opcode) + " after the end of the data");
    });
  }

  void contradict(std::string text) {
    std::vector<std::string>& found = index_.info.contradictions;
    if (found.size() < kMostNoted) {
      found.push_back(std::move(text));
    } else if (found.size() == kMostNoted) {
      found.emplace_back("and more of the kind");
    }
  }

  /// False when the file goes on as if it had none, and the caller wants what is left of it.
  bool takeHeader(const RecordPlace& place) {
    if (place.opcode == Opcode::kHeader) {
      guarded(place, [&](ByteView body) { index_.info.header = decodeHeader(body); });
      return true;
    }
    const std::string what = "it begins with " + opcodeName(place.opcode) + " where a Header is required";
    if (!options_.on_damage) throw NotARecording(file_.path().string() + " is not an MCAP recording: " + what);
    options_.on_damage({.offset = place.offset, .reason = what});
    return false;
  }

  /// decode(body) of a record outside of chunks, unless it is damaged and left out.
  template <class Decode>
  void guarded(const RecordPlace& place, Decode decode) {
    guarded(place, place, decode);
  }
  /// @param part  of it, that is read.
  template <class Decode>
  void guarded(const RecordPlace& place, const RecordPlace& part, Decode decode) {
    const Extent extent{.offset = place.offset, .length = place.length(), .is_chunk = false};
    (void)loader_.guarded(extent, [&] { decode(readBody(file_, part, options_, storage_)); });
  }

  /// Where the records cannot be followed any more, because none is there, because the lengths in one disagree, or
  /// because it was cut and reaches into another recording, a caller who wants what is left gets what follows from the
  /// next record on that can be told by its shape. False when all is well or nothing follows.
  bool goOnBehindDamage(RecordWalk& walk, const std::optional<RecordPlace>& place) {
    const std::uint64_t from = place ? place->offset : walk.position();
    const bool disagrees = place && is_data_ && isTorn(*place);
    std::optional<std::uint64_t> next;
    if (disagrees || !walk.problem().empty()) {
      next = is_data_ ? dataAfter(from) : search_.recordingIn(from, file_.size());
    } else if (place) {
      next = recordingInTorn(walk, *place);
    }
    if (!next) return false;
    settle();
    if (is_data_) {  // an index can be made again
      if (place && place->opcode == Opcode::kChunk) ++index_.statistics.chunk_count;
      lose({.offset = from,
            .length = *next - from,
            .reason = place ? whyTorn(*place, disagrees) : walk.problem(),
            .chunks = place && place->opcode == Opcode::kChunk ? std::uint64_t{1} : 0});
    }
    walk.moveTo(*next);
    return true;
  }

  /// Where nothing followed, nothing does later: each record of many may be torn.
  [[nodiscard]] std::optional<std::uint64_t> dataAfter(std::uint64_t torn) {
    if (fruitless_ == has_loose_) return std::nullopt;
    const std::optional<std::uint64_t> next = search_.dataAfter(torn, has_loose_);
    if (!next) fruitless_ = has_loose_;
    return next;
  }

  /// Reports it, or throws it when nobody wants what is left.
  void lose(const Damage& damage) const {
    if (!options_.on_damage) throw FormatError(file_.path().string() + ": " + describe(damage));
    options_.on_damage(damage);
  }

  [[nodiscard]] std::string whyTorn(const RecordPlace& place, bool disagrees) const {
    const std::string what = "the " + opcodeName(place.opcode) + " there ";
    if (!disagrees) return what + "is cut, another recording begins in it";
    const std::uint64_t zeros = zerosAt(file_, place.offset + kRecordHeadBytes, file_.size());
    return zeros < leastBytes(place.opcode) ? "the lengths of " + what + "disagree"
                                            : what + "has " + zerosText(zeros) + ", in the place of its fields";
  }

  [[nodiscard]] bool isTorn(const RecordPlace& place) const {
    if (place.opcode != Opcode::kFooter) return !fits(file_, place);
    return place.end() + kMagic.size() <= file_.size() && !hasMagic(file_, place.end());
  }

  /// The recording that begins in a record which was cut, so that its length is more than was written of it. (Of a
  /// chunk that shows when it is loaded.)
  [[nodiscard]] std::optional<std::uint64_t> recordingInTorn(RecordWalk& walk, const RecordPlace& place) {
    if (place.opcode == Opcode::kChunk) return std::nullopt;
    const bool is_dear = place.length() > kRunBytes || (is_data_ && belongsToRun(place.opcode));
    if (is_dear && isFollowed(file_, place, walk.peek())) return std::nullopt;
    const std::optional<std::uint64_t> next = recordingBeyond(place.offset, place.end());
    return next && !isSoundAttachment(walk, place) ? next : std::nullopt;
  }

  static bool belongsToRun(Opcode opcode) {
    return opcode == Opcode::kSchema || opcode == Opcode::kChannel || opcode == Opcode::kMessage;
  }

  /// By its CRC or, without one, by what follows it. A recording that is attached may have been cut.
  [[nodiscard]] bool isSoundAttachment(RecordWalk& walk, const RecordPlace& place) const {
    if (place.opcode != Opcode::kAttachment) return false;
    const std::uint64_t crc_at = place.end() - sizeof(std::uint32_t);
    const std::uint64_t crc = numberAt<std::uint32_t>(file_, crc_at);
    if (crc == 0) return isFollowed(file_, place, walk.peek());
    return crcOf(file_, place.offset + kRecordHeadBytes, crc_at) == crc;
  }

  /// See Search; each record of many may claim to reach to the end of the file.
  [[nodiscard]] std::optional<std::uint64_t> recordingBeyond(std::uint64_t record, std::uint64_t end) {
    if (index_.info.beginnings.size() >= kMostJoined) return std::nullopt;
    return search_.recordingBeyond(record, end);
  }

  void take(const RecordPlace& place) {
    noteHiddenChunk(place);
    if (place.opcode != Opcode::kMessageIndex) closeMessageIndexes();
    const bool belongs_to_run = belongsToRun(place.opcode);
    if (!belongs_to_run || run_.length + place.length() > kRunBytes) closeRun();
    if (belongs_to_run) {
      has_loose_ = has_loose_ || place.opcode == Opcode::kMessage;
      if (run_.length == 0) run_.offset = place.offset;
      run_.length += place.length();
    } else if (place.opcode == Opcode::kChunk) {
      ++index_.statistics.chunk_count;
      takeExtent({.offset = place.offset, .length = place.length()});
    } else if (place.opcode == Opcode::kMessageIndex) {
      checkMessageIndex(place);
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
      if (!is_known) ++index_.info.unknown_records;
      hidden_ = is_known || previous_ == Opcode::kChunk ? std::nullopt : std::optional(place);
    } else if (hidden_ && options_.on_damage) {
      options_.on_damage({.offset = hidden_->offset,
                          .length = hidden_->length(),
                          .reason = "it is indexed as a chunk, and is of no known kind",
                          .chunks = 1});
      --index_.info.unknown_records;
      ++index_.statistics.chunk_count;
      hidden_.reset();
    }
    previous_ = place.opcode;
  }

  void takeAttachment(const RecordPlace& place) {
    // Enough for the head; the data after it are bounded by the record's own length.
    RecordPlace front = place;
    front.body_length = std::min(place.body_length, kAttachmentHeadBytes);
    guarded(place, front, [&](ByteView body) {
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

  void settle() {
    closeChunk();
    closeRun();
  }

  void closeRun() {
    const Extent run = std::exchange(run_, {.is_chunk = false});
    if (run.length > 0) takeExtent(run);
  }

  /// Learns the schemas and channels of an extent and counts its messages.
  void takeExtent(const Extent& extent) {
    if (options_.on_progress) options_.on_progress(extent.offset, file_.size());
    Contents found{.extent = extent};
    Extent damaged = extent;
    std::optional<Damage> loss = loader_.attempt(damaged, [&] {
      try {
        readContents(loader_.load(extent, storage_), declarations_, found);
        const bool is_torn = found.bad.has_lost_track && recordingBeyond(extent.offset, extent.offset + extent.length);
        if (!found.bad.first.empty() && (is_torn || !loader_.isTolerant())) throw FormatError(found.bad.first);
      } catch (const FormatError&) {
        if (extent.is_chunk) torn_into_ = recordingBeyond(extent.offset, extent.offset + extent.length);
        if (torn_into_) damaged.length = *torn_into_ - extent.offset;  // the rest is of that recording
        throw;
      }
      if (!found.undeclared.empty() && !loader_.isTolerant()) throw FormatError(undeclaredIn(found).reason);
    });
    for (std::string& text : found.contradictions) contradict(std::move(text));
    index_.info.unknown_records += found.unknown;
    const bool is_lost = loss.has_value(), is_sound = !is_lost && found.bad.first.empty();
    if (!is_lost && !is_sound) loss = badIn(found);
    if (is_lost) found.entries.clear();
    if (extent.is_chunk) {
      indexed_ = {.chunk = extent, .entries = std::move(found.entries), .loss = loss};
    } else if (loss) {
      options_.on_damage(*loss);
    }
    if (is_lost) return;
    if (!found.undeclared.empty()) options_.on_damage(undeclaredIn(found));
    if (!found.misplaced.empty()) leaveOut(misplacedIn(found));
    if (found.counts.empty()) return;
    if (extent.is_chunk && is_sound && found.undeclared.empty()) checkTimes(found.extent);
    Statistics& statistics = index_.statistics;
    const bool is_first = index_.extents.empty();
    statistics.start_time_ns =
        is_first ? found.extent.start_time_ns : std::min(statistics.start_time_ns, found.extent.start_time_ns);
    statistics.end_time_ns = std::max(statistics.end_time_ns, found.extent.end_time_ns);
    for (const auto& [id, count] : found.counts) {
      statistics.channel_message_counts[id] += count;
      statistics.message_count += count;
    }
    index_.extents.push_back(std::move(found.extent));
  }

  /// Of a chunk whose messages are sound: no reason to refuse it.
  void leaveOut(const Damage& misplaced) {
    if (loader_.isTolerant()) {
      options_.on_damage(misplaced);
    } else {
      contradict(misplaced.reason);
    }
  }

  /// What a chunk's head says of its messages.
  void checkTimes(const Extent& chunk) {
    const std::uint64_t body = chunk.offset + kRecordHeadBytes;
    const auto start = numberAt<std::uint64_t>(file_, body), end = numberAt<std::uint64_t>(file_, body + 8);
    if (start == chunk.start_time_ns && end == chunk.end_time_ns) return;
    contradict("the " + placeOf(chunk) + " gives its messages the times " + std::to_string(start) + " to " +
               std::to_string(end) + " ns, they have " + std::to_string(chunk.start_time_ns) + " to " +
               std::to_string(chunk.end_time_ns));
  }

  /// Holds a message index against the messages of the chunk before it.
  void checkMessageIndex(const RecordPlace& place) {
    if (!indexed_) return;
    indexed_->has_index = true;
    guarded(place, [&](ByteView body) {
      MessageIndex index = decodeMessageIndex(body);
      std::ranges::sort(index.entries, {}, &MessageIndex::Entry::offset);
      const auto expected = indexed_->entries.extract(index.channel_id);
      if (indexed_->loss) {
        const std::size_t read = expected.empty() ? 0 : expected.mapped().size();
        indexed_->lost_messages += index.entries.size() - std::min(read, index.entries.size());
        return;
      }
      if (expected.empty() ? index.entries.empty() : expected.mapped() == index.entries) return;
      contradict("the message index at byte " + std::to_string(place.offset) +
                 " is not that of the messages of channel " + std::to_string(static_cast<unsigned>(index.channel_id)) +
                 " in the " + placeOf(indexed_->chunk));
    });
  }

  /// A chunk has no message index at all, or one for each of its channels.
  void closeMessageIndexes() {
    if (indexed_ && !indexed_->loss && indexed_->has_index && !indexed_->entries.empty()) {
      contradict("the message indexes after the " + placeOf(indexed_->chunk) + " leave out channel " +
                 std::to_string(static_cast<unsigned>(indexed_->entries.begin()->first)));
    }
    closeChunk();
  }

  /// What a damaged chunk held, its message indexes still say.
  void closeChunk() {
    if (indexed_ && indexed_->loss) {
      indexed_->loss->messages = std::max(indexed_->loss->messages, indexed_->lost_messages);
      options_.on_damage(*indexed_->loss);
    }
    indexed_.reset();
  }

  /// A finished recording ends with the magic behind its footer.
  void closeFile(const RecordPlace& footer) {
    FileInfo& info = index_.info;
    info.complete_bytes = footer.end();
    const std::uint64_t between = footer.offset - std::min(data_end_, footer.offset);
    if (!is_data_ && between > 0 && numberAt<std::uint64_t>(file_, footer.offset + kRecordHeadBytes) == 0) {
      contradict("its footer at byte " + std::to_string(footer.offset) + " gives no summary, though " +
                 std::to_string(between) + " bytes of one lie before it");
    }
    is_closed_ = hasMagic(file_, footer.end()) && !beginsRecording(file_, footer.end());
    if (!is_closed_) {
      info.problem = "cut at byte " + std::to_string(footer.end()) + ": the closing magic does not follow the footer";
      return;
    }
    info.complete_bytes += kMagic.size();
    info.problem.clear();
  }

  void noteSchemas() {
    for (std::string& text : declarations_.withoutSchema()) contradict(std::move(text));
  }

  FileIndex finish() {
    noteSchemas();
    FileInfo& info = index_.info;
    info.is_cut = !is_closed_ || !cut_.empty();
    info.is_complete = !info.is_cut && info.foreign.empty();
    if (!is_closed_ && !info.has_all_data) {
      info.cuts.push_back(
          {.offset = info.complete_bytes, .length = file_.size() - info.complete_bytes, .reason = info.problem});
    }
    if (!cut_.empty()) {
      info.has_all_data = false;
      info.complete_bytes = cut_at_;
      info.problem = cut_ + (info.problem.empty() ? "" : "; " + info.problem);
    }
    const std::string foreign = describeForeign(info.foreign);
    info.problem += (info.problem.empty() || foreign.empty() ? "" : "; ") + foreign;
    Statistics& statistics = index_.statistics;
    statistics.schema_count = static_cast<std::uint16_t>(index_.schemas.size());
    statistics.channel_count = static_cast<std::uint32_t>(index_.channels.size());
    statistics.attachment_count = static_cast<std::uint32_t>(index_.attachments.size());
    statistics.metadata_count = static_cast<std::uint32_t>(index_.metadata.size());
    return std::move(index_);
  }

  struct IndexedChunk {
    Extent chunk;
    std::map<ChannelId, std::vector<MessageIndex::Entry>> entries{};  // that no message index has listed yet
    bool has_index = false;
    std::optional<Damage> loss{};  // of all of it, or of some
    std::uint64_t lost_messages = 0;
  };

  const InputFile& file_;
  const ReaderOptions& options_;
  ExtentLoader loader_;
  Search search_;
  Buffer storage_;
  FileIndex index_;
  Declarations declarations_;
  bool is_first_ = true;                    // no record of the recording has been read yet
  bool is_data_ = true;                     // and not the end of its data
  std::uint64_t data_end_ = 0;              // where the last record of the data ends
  bool is_closed_ = false;                  // its footer and its magic have been read
  bool has_loose_ = false;                  // messages outside of chunks
  std::optional<bool> fruitless_{};         // a search found nothing to go on with, for loose messages or without
  std::string cut_;                         // the first recording that has no end, and that another one follows
  std::uint64_t cut_at_ = 0;                // where that one ends
  std::optional<std::uint64_t> torn_into_;  // the recording that begins in the chunk that was just taken
  std::optional<IndexedChunk> indexed_;     // the chunk that message indexes may follow
  Opcode previous_{};                       // of the record before
  std::optional<RecordPlace> hidden_;       // a record that may have been a chunk
  Extent run_{.is_chunk = false};           // consecutive records outside of chunks; empty when length is 0
};

}  // namespace

FileIndex scanFile(const InputFile& file, const ReaderOptions& options, std::uint64_t begin, const FileIndex* summary) {
  return Scan(file, options, summary).run(begin);
}

}  // namespace baton::mcap
