#include "mcap/index.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "base/plural.hpp"
#include "base/text.hpp"
#include "mcap/crc.hpp"
#include "mcap/foreign.hpp"
#include "mcap/shape.hpp"

namespace baton::mcap {
namespace {

constexpr std::size_t kWindowBytes = 16 << 10;
constexpr std::uint64_t kTailBytes = kFooterBytes + kMagic.size();

/// What a summary lists of the data section.
struct Piece {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  // of the record
  Opcode kind{};
  std::uint64_t indexes_length = 0;  // of the message indexes after it
  bool operator<(const Piece& other) const { return offset < other.offset; }
};

/// The record that a piece claims, as "a Chunk of 52 bytes at byte 29", is there.
bool isThere(const InputFile& file, const Piece& piece, std::uint64_t data_end, SummaryProblem& problem) {
  std::optional<RecordPlace> place;
  if (piece.offset < data_end) place = RecordWalk(file, piece.offset, data_end).next();
  const bool is_right = place && place->opcode == piece.kind && place->length() == piece.length &&
                        piece.indexes_length <= data_end - place->end();
  if (is_right) return true;
  const std::string kind = opcodeName(piece.kind);
  problem = {"its summary lists a record " + kind + " of " + std::to_string(piece.length) + " bytes at byte " +
             std::to_string(piece.offset) + ", where "};
  if (!place || place->opcode != piece.kind) {
    problem.text += "none begins";
  } else if (place->length() != piece.length) {
    problem.text += "the one that is there has " + std::to_string(place->length());
  } else {
    problem.text += std::to_string(piece.indexes_length) + " bytes of message indexes cannot follow";
  }
  return false;
}

/// A summary is trusted only when what it lists accounts for the whole data section: each piece there, none
/// overlapping, and between them only records that carry no data. So an index that leaves out messages is never
/// believed.
bool coversData(const InputFile& file, std::vector<Piece> pieces, std::uint64_t data_begin, std::uint64_t summary_start,
                SummaryProblem& problem) {
  std::ranges::sort(pieces, std::less());
  std::uint64_t position = data_begin;
  bool has_data_end = false;
  const auto gapIsQuiet = [&](std::uint64_t end) {
    RecordWalk walk(file, position, end);
    while (const std::optional<RecordPlace> place = walk.next()) {
      switch (place->opcode) {
        case Opcode::kHeader:
        case Opcode::kFooter:
        case Opcode::kMessage:
        case Opcode::kChunk:
        case Opcode::kAttachment:
        case Opcode::kMetadata:
          problem = {"its summary does not list the " + opcodeName(place->opcode) + " at byte " +
                         std::to_string(place->offset),
                     place->opcode == Opcode::kMessage};
          return false;
        case Opcode::kDataEnd: has_data_end = place->end() == summary_start; break;
        default: break;
      }
    }
    if (!walk.problem().empty()) problem = {"its summary does not fit its data: " + walk.problem()};
    return walk.problem().empty();
  };
  for (const Piece& piece : pieces) {
    if (!isThere(file, piece, summary_start, problem)) return false;
    if (piece.offset < position) {
      problem = {"its summary lists the data at byte " + std::to_string(piece.offset) + " twice"};
      return false;
    }
    if (!gapIsQuiet(piece.offset)) return false;
    position = piece.offset + piece.length + piece.indexes_length;
  }
  if (!gapIsQuiet(summary_start)) return false;
  if (!has_data_end) problem = {"its summary does not follow the end of its data"};
  return problem.text.empty();
}

/// What the summary says of itself, apart from where the data are. A kind of record of which it lists none at all may
/// be left out, as the format has it; one of which it lists some must be there whole.
SummaryProblem inconsistency(const FileIndex& index, bool has_statistics) {
  const Statistics& statistics = index.statistics;
  if (!has_statistics) return {"its summary has no statistics", true};
  const auto incomplete = [](const char* kind, std::size_t listed) {
    return SummaryProblem{std::string("its summary does not list every ") + kind, listed == 0};
  };
  if (statistics.chunk_count != index.extents.size()) return incomplete("chunk", index.extents.size());
  if (statistics.attachment_count != index.attachments.size())
    return incomplete("attachment", index.attachments.size());
  if (statistics.metadata_count != index.metadata.size()) return incomplete("metadata record", index.metadata.size());
  if (statistics.channel_count != index.channels.size()) return incomplete("channel", index.channels.size());
  if (statistics.schema_count != index.schemas.size()) return incomplete("schema", index.schemas.size());
  std::uint64_t counted = 0;
  for (const auto& [id, count] : statistics.channel_message_counts) {
    if (!index.channels.contains(id)) return {"its summary counts messages of a channel it does not list"};
    counted += count;
  }
  if (counted != statistics.message_count) return {"its summary's message counts do not add up"};
  for (const auto& [id, channel] : index.channels) {
    if (channel.schema_id != kNoSchema && !index.schemas.contains(channel.schema_id)) {
      return incomplete("schema", index.schemas.size());
    }
  }
  if (statistics.chunk_count == 0 && statistics.message_count != 0) return {"its messages are not indexed", true};
  return {};
}

/// Where the records of a summary lie, by kind.
class Groups {
 public:
  void add(Opcode opcode, std::uint64_t begin, std::uint64_t end) {
    groups_.try_emplace(opcode, begin, end).first->second.second = end;
  }
  /// What is wrong with the summary's own index; empty when nothing is.
  [[nodiscard]] std::string problem(const std::vector<SummaryOffset>& offsets, std::uint64_t offsets_start) const {
    for (const SummaryOffset& one : offsets) {
      const auto group = groups_.find(one.group);
      if (group == groups_.end() && one.group_length == 0) continue;  // some writers list groups that they do not have
      const auto [begin, end] = group == groups_.end() ? std::pair<std::uint64_t, std::uint64_t>{} : group->second;
      if (group != groups_.end() && begin == one.group_start && end - begin == one.group_length) continue;
      return "its summary gives " + std::to_string(one.group_length) + " bytes at byte " +
             std::to_string(one.group_start) + " for its records " + opcodeName(one.group) + ", which are not those";
    }
    const auto group = groups_.find(Opcode::kSummaryOffset);
    if (offsets_start == (group == groups_.end() ? 0 : group->second.first)) return "";
    return "its footer gives byte " + std::to_string(offsets_start) + " for the offsets in its summary, which is wrong";
  }

 private:
  std::map<Opcode, std::pair<std::uint64_t, std::uint64_t>> groups_;
};

}  // namespace

std::optional<RecordPlace> RecordWalk::next() {
  const std::uint64_t left = end_ - position_;
  if (left == 0 || !problem_.empty()) return std::nullopt;
  const std::string here = std::to_string(position_);
  if (left < kRecordHeadBytes) {
    problem_ = "byte " + here + ": " + std::to_string(left) + " bytes are left, too few for a record";
    return std::nullopt;
  }
  if (position_ < window_begin_ || position_ + kRecordHeadBytes > window_end_) {
    window_begin_ = position_;
    window_end_ = position_ + std::min<std::uint64_t>(left, kWindowBytes);
    window_ = storage_.resize(static_cast<std::size_t>(window_end_ - window_begin_));
    file_.read(window_begin_, window_);
  }
  ByteReader in(window_.subspan(static_cast<std::size_t>(position_ - window_begin_), kRecordHeadBytes));
  const RecordPlace place{
      .opcode = Opcode{in.number<std::uint8_t>()}, .offset = position_, .body_length = in.number<std::uint64_t>()};
  if (place.opcode == Opcode::kInvalid) {
    problem_ = "byte " + here + ": " + zerosText(zerosAt(file_, position_, end_)) + ", are in the place of a record";
    return std::nullopt;
  }
  if (place.body_length > left - kRecordHeadBytes) {
    problem_ = "byte " + here + ": the " + opcodeName(place.opcode) + " there claims " +
               std::to_string(place.body_length) + " bytes and " + std::to_string(left - kRecordHeadBytes) +
               " are left";
    return std::nullopt;
  }
  position_ = place.end();
  return place;
}

std::optional<RecordPlace> RecordWalk::peek() {
  const std::uint64_t here = position_;
  const std::string problem = problem_;
  const std::optional<RecordPlace> place = next();
  position_ = here;
  problem_ = problem;
  return place;
}

ByteView readBody(const InputFile& file, const RecordPlace& place, const ReaderOptions& options, Buffer& storage) {
  if (place.body_length > options.max_chunk_bytes) {
    throw FormatError(file.path().string() + ": the " + opcodeName(place.opcode) + " at byte " +
                      std::to_string(place.offset) + " has " + std::to_string(place.body_length) +
                      " bytes, above the limit of " + std::to_string(options.max_chunk_bytes));
  }
  const std::span<std::byte> body = storage.resize(static_cast<std::size_t>(place.body_length));
  file.read(place.offset + kRecordHeadBytes, body);
  return body;
}

namespace {

/// The records of a summary.
struct SummaryContents {
  FileIndex index{};  // without a header
  std::vector<Piece> pieces{};
  std::vector<ChunkIndex> chunks{};
  std::vector<SummaryOffset> offsets{};
  Groups groups{};
  bool has_statistics = false;
};

/// Throws FormatError where they cannot be read: what comes before is in `contents`.
void decodeSummary(ByteView records, std::uint64_t begin, SummaryContents& contents) {
  FileIndex& index = contents.index;
  ByteReader in(records);
  for (std::uint64_t at = begin; const std::optional<RecordView> record = nextRecord(in);) {
    const std::uint64_t end = begin + in.position();
    contents.groups.add(record->opcode, std::exchange(at, end), end);
    switch (record->opcode) {
      case Opcode::kSchema: {
        Schema schema = decodeSchema(record->body);
        index.schemas.emplace(schema.id, std::move(schema));
        break;
      }
      case Opcode::kChannel: {
        Channel channel = decodeChannel(record->body);
        index.channels.emplace(channel.id, std::move(channel));
        break;
      }
      case Opcode::kStatistics:
        index.statistics = decodeStatistics(record->body);
        contents.has_statistics = true;
        break;
      case Opcode::kChunkIndex: {
        const ChunkIndex chunk = decodeChunkIndex(record->body);
        Extent extent{.offset = chunk.chunk_offset,
                      .length = chunk.chunk_length,
                      .start_time_ns = chunk.start_time_ns,
                      .end_time_ns = chunk.end_time_ns};
        for (const auto& [id, offset] : chunk.message_index_offsets) extent.channels.push_back(id);
        contents.pieces.push_back({.offset = extent.offset,
                                   .length = extent.length,
                                   .kind = Opcode::kChunk,
                                   .indexes_length = chunk.message_index_length});
        index.extents.push_back(std::move(extent));
        contents.chunks.push_back(chunk);
        break;
      }
      case Opcode::kAttachmentIndex:
        index.attachments.push_back(decodeAttachmentIndex(record->body));
        contents.pieces.push_back({.offset = index.attachments.back().offset,
                                   .length = index.attachments.back().length,
                                   .kind = Opcode::kAttachment});
        break;
      case Opcode::kMetadataIndex:
        index.metadata.push_back(decodeMetadataIndex(record->body));
        contents.pieces.push_back({.offset = index.metadata.back().offset,
                                   .length = index.metadata.back().length,
                                   .kind = Opcode::kMetadata});
        break;
      case Opcode::kSummaryOffset: contents.offsets.push_back(decodeSummaryOffset(record->body)); break;
      case Opcode::kMessage:
      case Opcode::kChunk:
      case Opcode::kAttachment:
      case Opcode::kMetadata: throw FormatError("it holds data: a record " + opcodeName(record->opcode));
      default: break;
    }
  }
}

}  // namespace

std::optional<FileIndex> readSummary(const InputFile& file, const ReaderOptions& options, SummaryProblem& problem,
                                     SummaryClaims* claims) {
  if (file.size() < kMagic.size() + kTailBytes) return std::nullopt;
  const std::uint64_t footer_at = file.size() - kTailBytes;
  std::array<std::byte, kTailBytes> tail;
  file.read(footer_at, tail);
  ByteReader tail_reader(tail);
  const auto opcode = Opcode{tail_reader.number<std::uint8_t>()};
  const auto length = tail_reader.number<std::uint64_t>();
  if (opcode != Opcode::kFooter || length != kFooterBytes - kRecordHeadBytes ||
      !std::ranges::equal(std::span(tail).last<kMagic.size()>(), kMagic)) {
    return std::nullopt;  // cut off: a scan will tell where
  }
  const Footer footer = decodeFooter(tail_reader.rest());
  if (footer.summary_start == 0) return std::nullopt;
  if (footer.summary_start < kMagic.size() || footer.summary_start > footer_at ||
      footer_at - footer.summary_start > options.max_chunk_bytes) {
    problem = {"its footer gives byte " + std::to_string(footer.summary_start) + " for a summary that cannot be there"};
    return std::nullopt;
  }

  try {
    // The summary and the footer up to its CRC, which covers both.
    Buffer storage;
    const std::span<std::byte> bytes = storage.resize(static_cast<std::size_t>(footer_at - footer.summary_start) +
                                                      kFooterBytes - sizeof(std::uint32_t));
    file.read(footer.summary_start, bytes);
    const bool is_sound = !options.check_crc || footer.summary_crc == 0 || crc32(bytes) == footer.summary_crc;
    SummaryContents contents;
    std::string unreadable;
    try {
      decodeSummary(bytes.first(static_cast<std::size_t>(footer_at - footer.summary_start)), footer.summary_start,
                    contents);
    } catch (const FormatError& error) {
      unreadable = error.what();
    }
    FileIndex& index = contents.index;
    if (claims != nullptr) {
      if (contents.has_statistics) claims->statistics = index.statistics;
      claims->declarations.schemas = index.schemas;
      claims->declarations.channels = index.channels;
    }
    if (!is_sound) throw FormatError("its CRC is wrong");
    if (!unreadable.empty()) throw FormatError(unreadable);
    std::ranges::sort(index.extents, {}, &Extent::offset);
    problem = inconsistency(index, contents.has_statistics);
    if (!problem.text.empty()) return std::nullopt;

    RecordWalk walk(file, kMagic.size(), footer.summary_start);
    const std::optional<RecordPlace> first = walk.next();
    if (!first || first->opcode != Opcode::kHeader) return std::nullopt;  // the scan says so
    index.info.header = decodeHeader(readBody(file, *first, options, storage));
    if (!coversData(file, std::move(contents.pieces), first->end(), footer.summary_start, problem)) return std::nullopt;
    // What is of use to others only is nothing to those who look at the metadata.
    if (!options.trusts_summary) problem.text = contents.groups.problem(contents.offsets, footer.summary_offset_start);
    for (auto one = contents.chunks.begin();
         one != contents.chunks.end() && !options.trusts_summary && problem.text.empty(); ++one) {
      problem.text = problemOf(file, *one);
    }
    if (!problem.text.empty()) return std::nullopt;
    index.info.file_bytes = index.info.complete_bytes = file.size();
    index.info.is_complete = index.info.has_all_data = index.info.has_summary = true;
    return std::move(index);
  } catch (const FormatError& error) {
    problem = {std::string("its summary is damaged: ") + error.what()};
    return std::nullopt;
  }
}

FileIndex indexFile(const InputFile& file, const ReaderOptions& options) {
  const std::uint64_t begin = firstRecording(file);
  SummaryProblem problem;
  SummaryClaims claims;
  std::optional<FileIndex> summary;  // its places count from the beginning of the recording
  if (begin == 0) summary = readSummary(file, options, problem, &claims);
  if (summary && options.trusts_summary) return *summary;
  if (summary) {
    // Read all of it: only then is it known that no chunk holds other messages than the summary says.
    std::vector<Damage> damage;
    ReaderOptions tolerant = options;
    tolerant.on_damage = [&damage](const Damage& found) { damage.push_back(found); };
    FileIndex found = scanFile(file, tolerant, begin, &claims.declarations);
    if (options.on_damage) std::ranges::for_each(damage, options.on_damage);
    const auto lost =
        std::ranges::find_if(damage, [](const Damage& one) { return one.length == 0 && one.messages > 0; });
    problem.text = !found.info.is_complete ? "its data cannot be followed to their end: " + found.info.problem
                   : lost == damage.end()  ? contradictionOf(*summary, found, !damage.empty())
                                           : "its summary is not that of its data: " + describe(*lost);
    found.info.claimed = claims.statistics;
    if (problem.text.empty()) {
      summary->info.claimed = claims.statistics;
      summary->info.unknown_records = found.info.unknown_records;
      return *std::move(summary);
    }
    if (options.on_damage || damage.empty()) {
      if (found.info.problem.empty()) found.info.problem = problem.text;
      return found;
    }
  }
  FileIndex index = scanFile(file, options, begin, &claims.declarations);
  index.info.claimed = claims.statistics;
  if (index.info.problem.empty()) {
    index.info.problem = problem.text;
    index.info.is_unindexed = problem.is_omission;
  }
  return index;
}

std::uint64_t lengthOf(const std::vector<Damage>& damage) {
  std::uint64_t sum = 0, end = 0;
  for (const Damage& one : damage) {
    const std::uint64_t begin = std::max(end, one.offset), one_end = one.offset + one.length;
    if (one_end <= begin) continue;
    sum += one_end - begin;
    end = one_end;
  }
  return sum;
}

std::string describe(const Damage& damage) {
  if (damage.length == 0) {
    return damage.messages > 0 ? std::to_string(damage.messages) + " " + damage.reason
                               : "something is missing at byte " + std::to_string(damage.offset) + ": " + damage.reason;
  }
  return counted(damage.length, "byte") + " at byte " + std::to_string(damage.offset) +
         (damage.messages > 0 ? ", with " + counted(damage.messages, "message") + "," : "") +
         " cannot be read: " + damage.reason;
}

}  // namespace baton::mcap
