#include "mcap/reader.hpp"

#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "mcap/crc.hpp"
#include "mcap/shape.hpp"

namespace baton::mcap {
namespace {

/// The record an index points at, checked to be what the index says.
RecordPlace recordAt(const InputFile& file, Opcode opcode, std::uint64_t offset, std::uint64_t length) {
  std::optional<RecordPlace> place;
  if (offset <= file.size() && length <= file.size() - offset) place = RecordWalk(file, offset, offset + length).next();
  if (!place || place->opcode != opcode || place->length() != length) {
    throw FormatError(file.path().string() + ": the index gives byte " + std::to_string(offset) + " for a record " +
                      opcodeName(opcode) + " that is not there");
  }
  return *place;
}

OpeningSink& openingSink() {
  static OpeningSink sink;
  return sink;
}

/// Passes over a file come across the same damage: it is reported once.
ReaderOptions reportingOnce(ReaderOptions options) {
  if (!options.on_damage) return options;
  using Reported = std::set<std::tuple<std::uint64_t, std::uint64_t, std::string>>;
  options.on_damage = [report = std::move(options.on_damage),
                       reported = std::make_shared<Reported>()](const Damage& damage) {
    if (reported->emplace(damage.offset, damage.length, damage.reason).second) report(damage);
  };
  return options;
}

/// indexFile(), shown by the program's sink when nothing else shows it.
FileIndex indexShown(const InputFile& file, const ReaderOptions& options) {
  if (!openingSink() || options.on_progress) return indexFile(file, options);
  ReaderOptions shown = options;
  shown.on_progress = [&file](std::uint64_t done, std::uint64_t of) { openingSink()(file.path(), done, of); };
  struct AtTheEnd {
    const InputFile& file;
    ~AtTheEnd() { openingSink()(file.path(), file.size(), file.size()); }
  };
  const AtTheEnd end{file};
  return indexFile(file, shown);
}

}  // namespace

void setOpeningSink(OpeningSink sink) { openingSink() = std::move(sink); }

Reader::Reader(const std::filesystem::path& path, ReaderOptions options)
    : options_(reportingOnce(std::move(options))), file_(path), index_(indexShown(file_, options_)) {}

Bytes Reader::readAttachment(const AttachmentIndex& attachment) const {
  const RecordPlace place = recordAt(file_, Opcode::kAttachment, attachment.offset, attachment.length);
  // Asked for by name, so the file's size is limit enough.
  ReaderOptions options = options_;
  options.max_chunk_bytes = file_.size();
  return decodeRecord(file_, place, options, [&](ByteView body) {
    const AttachmentHead head = decodeAttachmentHead(body);
    ByteReader in(body.subspan(static_cast<std::size_t>(head.data_offset)));
    const ByteView data = in.bytes(head.data_size);
    const ByteView covered = body.first(body.size() - in.rest().size());
    const auto crc = in.number<std::uint32_t>();
    if (options_.check_crc && crc != 0 && crc32(covered) != crc) throw FormatError("its CRC is wrong: it is damaged");
    return Bytes(data.begin(), data.end());
  });
}

Metadata Reader::readMetadata(const MetadataIndex& index) const {
  const RecordPlace place = recordAt(file_, Opcode::kMetadata, index.offset, index.length);
  return decodeRecord(file_, place, options_, decodeMetadata);
}

std::vector<Metadata> Reader::metadata() const {
  std::vector<Metadata> all;
  all.reserve(index_.metadata.size());
  for (const MetadataIndex& index : index_.metadata) all.push_back(readMetadata(index));
  return all;
}

MessageCursor Reader::messages(const MessageFilter& filter) const {
  return MessageCursor(file_, index_, options_, filter);
}

void Reader::forEachMessage(const MessageFilter& filter,
                            const std::function<void(const MessageView&)>& callback) const {
  MessageCursor cursor = messages(filter);
  for (MessageView message; cursor.next(message);) callback(message);
}

std::optional<bool> Reader::dataCrcMatches() const {
  std::optional<bool> all;
  for (std::size_t i = 0; i < info().beginnings.size(); ++i) {
    const std::uint64_t end = i + 1 < info().beginnings.size() ? info().beginnings[i + 1] : file_.size();
    const std::optional<bool> one = dataCrcMatches(info().beginnings[i], end);
    if (one == false) return false;
    if (one) all = true;
  }
  return all;
}

/// Of one of the recordings in the file.
std::optional<bool> Reader::dataCrcMatches(std::uint64_t begin, std::uint64_t end) const {
  RecordWalk walk(file_, begin + kMagic.size(), end);
  std::optional<RecordPlace> place = walk.next();
  while (place && place->opcode != Opcode::kDataEnd) place = walk.next();
  if (!place) {
    // In a finished file it is there; who cannot come to it stumbles over a record that was changed.
    return info().is_complete ? std::optional(false) : std::nullopt;
  }
  const DataEnd data_end = decodeRecord(file_, *place, options_, decodeDataEnd);
  if (data_end.data_crc == 0) return std::nullopt;
  return crcOf(file_, begin, place->offset) == data_end.data_crc;
}

}  // namespace baton::mcap
