#include "mcap/index.hpp"

#include <algorithm>

#include "mcap/crc.hpp"

namespace baton::mcap {
namespace {

constexpr std::size_t kWindowBytes = 16 << 10;
constexpr std::uint64_t kTailBytes = kFooterBytes + kMagic.size();

/// A summary is trusted only when what it lists accounts for the whole data section: each piece inside, none
/// overlapping, and between them only records that carry no data. So an index that leaves out messages is never
/// believed.
bool coversData(const InputFile& file, std::vector<std::pair<std::uint64_t, std::uint64_t>> pieces,
                std::uint64_t data_begin, std::uint64_t summary_start, SummaryProblem& problem) {
  std::ranges::sort(pieces);
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
  for (const auto& [offset, length] : pieces) {
    if (offset < position || offset > summary_start || length > summary_start - offset) {
      problem = {"its summary lists data at byte " + std::to_string(offset) + " that cannot be there"};
      return false;
    }
    if (!gapIsQuiet(offset)) return false;
    position = offset + length;
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
    problem_ = "byte " + here + ": opcode 0 begins no record";
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

std::optional<FileIndex> readSummary(const InputFile& file, const ReaderOptions& options, SummaryProblem& problem) {
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
    if (options.check_crc && footer.summary_crc != 0 && crc32(bytes) != footer.summary_crc) {
      throw FormatError("its CRC is wrong");
    }

    FileIndex index;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> pieces;
    bool has_statistics = false;
    ByteReader in(bytes.first(static_cast<std::size_t>(footer_at - footer.summary_start)));
    while (const std::optional<RecordView> record = nextRecord(in)) {
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
          has_statistics = true;
          break;
        case Opcode::kChunkIndex: {
          const ChunkIndex chunk = decodeChunkIndex(record->body);
          Extent extent{.offset = chunk.chunk_offset,
                        .length = chunk.chunk_length,
                        .start_time_ns = chunk.start_time_ns,
                        .end_time_ns = chunk.end_time_ns};
          for (const auto& [id, offset] : chunk.message_index_offsets) extent.channels.push_back(id);
          if (chunk.chunk_length > file.size() || chunk.message_index_length > file.size()) {
            throw FormatError("a chunk is larger than the file");
          }
          pieces.emplace_back(extent.offset, extent.length + chunk.message_index_length);
          index.extents.push_back(std::move(extent));
          break;
        }
        case Opcode::kAttachmentIndex:
          index.attachments.push_back(decodeAttachmentIndex(record->body));
          pieces.emplace_back(index.attachments.back().offset, index.attachments.back().length);
          break;
        case Opcode::kMetadataIndex:
          index.metadata.push_back(decodeMetadataIndex(record->body));
          pieces.emplace_back(index.metadata.back().offset, index.metadata.back().length);
          break;
        default: break;
      }
    }
    std::ranges::sort(index.extents, {}, &Extent::offset);
    problem = inconsistency(index, has_statistics);
    if (!problem.text.empty()) return std::nullopt;

    RecordWalk walk(file, kMagic.size(), footer.summary_start);
    const std::optional<RecordPlace> first = walk.next();
    if (!first || first->opcode != Opcode::kHeader) return std::nullopt;  // the scan says so
    index.info.header = decodeHeader(readBody(file, *first, options, storage));
    if (!coversData(file, std::move(pieces), first->end(), footer.summary_start, problem)) return std::nullopt;
    index.info.file_bytes = index.info.complete_bytes = file.size();
    index.info.is_complete = index.info.has_all_data = index.info.has_summary = true;
    return index;
  } catch (const FormatError& error) {
    problem = {std::string("its summary is damaged: ") + error.what()};
    return std::nullopt;
  }
}

FileIndex indexFile(const InputFile& file, const ReaderOptions& options) {
  std::array<std::byte, kMagic.size()> magic{};
  if (file.size() >= kMagic.size()) file.read(0, magic);
  if (magic != kMagic) {
    throw FormatError(file.path().string() + " is not an MCAP recording: it does not begin with the MCAP magic");
  }
  SummaryProblem problem;
  if (std::optional<FileIndex> index = readSummary(file, options, problem)) return std::move(*index);
  FileIndex index = scanFile(file, options);
  if (index.info.problem.empty()) {
    index.info.problem = problem.text;
    index.info.is_unindexed = problem.is_omission;
  }
  return index;
}

}  // namespace baton::mcap
