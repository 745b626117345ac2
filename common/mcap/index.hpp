/// What a recording holds and where: found by reading the file from its start, which also works on a file that was cut
/// off, and taken from its summary where the data agree with it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mcap/file.hpp"
#include "mcap/records.hpp"

namespace baton::mcap {

/// A stretch of the file that cannot be used, and why.
struct Damage {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  // 0: all bytes could be read, and something is missing there
  std::string reason{};
  std::uint64_t messages = 0;  // that are lost there, as far as that is known
  std::uint64_t chunks = 0;    // likewise, whole
  auto operator<=>(const Damage&) const = default;
};
/// In a sentence: what is lost, where and why.
[[nodiscard]] std::string describe(const Damage& damage);
/// Of all of it, in bytes of the file; what overlaps counts once. @param damage  in the order of the file.
[[nodiscard]] std::uint64_t lengthOf(const std::vector<Damage>& damage);

struct ReaderOptions {
  /// Records and decompressed chunks above this are refused: no damaged length can exhaust the memory.
  std::uint64_t max_chunk_bytes = std::uint64_t{1} << 30;
  /// A file that decompresses to more than this, and to more than kMostInflation times its size, is refused: a few
  /// hundred bytes can claim gigabytes.
  std::uint64_t max_inflated_bytes = std::uint64_t{2} << 30;
  bool check_crc = true;  // of chunks, attachments and summary
  /// Takes the index of a summary without a look at the data: in no time, for what a file says of itself. Whether the
  /// summary is that of its data stays open; a file without one that can be used is read whole all the same.
  bool trusts_summary = false;
  /// When given, what is damaged is reported here and left out: all of it when the file is opened. Otherwise a damaged
  /// chunk is thrown as FormatError. A Reader reports the same damage once.
  std::function<void(const Damage&)> on_damage{};
  /// Told, chunk by chunk, how many bytes have been read of how many while a file is indexed.
  std::function<void(std::uint64_t, std::uint64_t)> on_progress{};
};

/// No honest recording reaches it: compressed telemetry has 3 to 60, with the index of its messages in the file.
inline constexpr std::uint64_t kMostInflation = 500;

struct FileInfo {
  Header header{};
  std::uint64_t file_bytes = 0;
  bool is_complete = false;  // it is a finished recording, or several, and nothing else
  bool is_cut = false;       // a recording in it has no end
  /// Up to here everything is a whole record; of joined recordings, up to where the first of them is cut. file_bytes
  /// when is_complete.
  std::uint64_t complete_bytes = 0;
  bool has_all_data = false;  // its data section ends as it should: if it was cut, then only in its index
  bool has_summary = false;   // the index is the file's own summary, which its data agree with
  std::string problem{};      // where it was cut and why, or why its summary was not used; empty when all is well
  bool is_unindexed = false;  // the problem is only that the summary leaves out what the format lets it leave out
  /// Where the file contradicts itself, a sentence each: ids with two meanings, indexes of other messages than there
  /// are, recordings one after another. All of it could be read, as the data have it.
  std::vector<std::string> contradictions{};
  std::vector<Damage> cuts{};                // where data of a recording in the file end too early
  std::vector<Damage> foreign{};             // bytes that belong to no recording, before, between and after them
  std::vector<std::uint64_t> beginnings{0};  // of recordings in the file: several, when files were joined
  std::uint64_t unknown_records = 0;         // of kinds that MCAP does not know
  std::optional<Statistics> claimed{};       // by its summary, whether the data agree or not
};

/// A stretch of the file that holds messages: a chunk, or consecutive records outside of any chunk.
struct Extent {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  bool is_chunk = true;
  std::uint64_t start_time_ns = 0;
  std::uint64_t end_time_ns = 0;
  std::vector<ChannelId> channels{};  // with a message in it; empty when not known

  /// From this place on, in its records, a channel's id means another channel of the index, or none.
  struct Meaning {
    std::uint64_t from = 0;
    ChannelId id{};
    std::optional<ChannelId> means{};
  };
  std::vector<Meaning> meanings{};  // where the id is not that of the index; by place
};

struct FileIndex {
  FileInfo info{};
  std::map<SchemaId, Schema> schemas{};
  std::map<ChannelId, Channel> channels{};
  Statistics statistics{};
  std::vector<Extent> extents{};  // in file order, not overlapping
  std::vector<AttachmentIndex> attachments{};
  std::vector<MetadataIndex> metadata{};
};

/// Reads the file from its start, and takes the index of its summary only when the data agree with it (or are not to be
/// asked, see ReaderOptions::trusts_summary). Throws FormatError when the file is not MCAP, or is damaged before its
/// end (see ReaderOptions::on_damage).
[[nodiscard]] FileIndex indexFile(const InputFile& file, const ReaderOptions& options);

/// Why a summary is not used.
struct SummaryProblem {
  std::string text{};
  bool is_omission = false;  // see FileInfo::is_unindexed
};

/// What a summary says, also when it is not used: it may be right in this and wrong in other things.
struct SummaryClaims {
  std::optional<Statistics> statistics{};
  FileIndex declarations{};  // schemas and channels
};

/// The two ways, for indexFile: nothing when the file has no summary or one that cannot be used, `problem` says why.
[[nodiscard]] std::optional<FileIndex> readSummary(const InputFile& file, const ReaderOptions& options,
                                                   SummaryProblem& problem, SummaryClaims* claims = nullptr);
/// @param begin    of the first recording in the file.
/// @param summary  declares the channels that the data do not declare before they are used; may be null.
[[nodiscard]] FileIndex scanFile(const InputFile& file, const ReaderOptions& options, std::uint64_t begin,
                                 const FileIndex* summary);

/// What a summary says that the data do not, in a sentence; empty when they agree. @param found  by a scan.
/// @param is_damaged  the scan could not read all of the data, so that it may have found less than there was.
[[nodiscard]] std::string contradictionOf(const FileIndex& summary, const FileIndex& found, bool is_damaged);

/// Where others would look for a chunk and its messages in vain, by its index, in a sentence; empty when all is there.
[[nodiscard]] std::string problemOf(const InputFile& file, const ChunkIndex& index);

/// A record's place in the file.
struct RecordPlace {
  Opcode opcode{};
  std::uint64_t offset = 0;
  std::uint64_t body_length = 0;
  [[nodiscard]] std::uint64_t length() const { return kRecordHeadBytes + body_length; }
  [[nodiscard]] std::uint64_t end() const { return offset + length(); }
};

/// Walks from record to record by their lengths, reading heads only.
class RecordWalk {
 public:
  /// @param end  records must lie before this byte.
  RecordWalk(const InputFile& file, std::uint64_t begin, std::uint64_t end)
      : file_(file), position_(begin), end_(end) {}

  /// The next record; nothing at the end or where no whole record follows, see problem().
  [[nodiscard]] std::optional<RecordPlace> next();
  /// What next() will find, without a move.
  [[nodiscard]] std::optional<RecordPlace> peek();
  /// The end of the last whole record.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  /// Goes on there, also where it had stopped.
  void moveTo(std::uint64_t position) {
    position_ = position;
    problem_.clear();
  }
  /// Where and why the walk stopped before its end, as "byte 12: ..."; empty when it did not.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  const InputFile& file_;
  std::uint64_t position_;
  std::uint64_t end_;
  std::string problem_;
  Buffer storage_;
  std::span<std::byte> window_;  // read ahead, as heads outside of chunks lie close together
  std::uint64_t window_begin_ = 0;
  std::uint64_t window_end_ = 0;
};

/// Reads a record's body; FormatError above the limit of the options.
[[nodiscard]] ByteView readBody(const InputFile& file, const RecordPlace& place, const ReaderOptions& options,
                                Buffer& storage);

/// decode(body) of a record's body; a FormatError of it gets the record's place added.
template <class Decode>
auto decodeRecord(const InputFile& file, const RecordPlace& place, const ReaderOptions& options, Decode decode) {
  Buffer storage;
  const ByteView body = readBody(file, place, options, storage);
  try {
    return decode(body);
  } catch (const FormatError& error) {
    throw FormatError(file.path().string() + ": " + opcodeName(place.opcode) + " at byte " +
                      std::to_string(place.offset) + ": " + error.what());
  }
}

}  // namespace baton::mcap
