#include "mcap/shape.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>

#include "mcap/crc.hpp"

namespace baton::mcap {
namespace {

/// Whether the name of a compression can lie there. Any letter is one: a chunk that is compressed in an unknown way is
/// a chunk.
bool isCompressionName(const InputFile& file, std::uint64_t offset) {
  constexpr std::size_t kLongest = 32;
  std::string name(
      static_cast<std::size_t>(std::min<std::uint64_t>(numberAt<std::uint32_t>(file, offset), kLongest + 1)), '\0');
  const std::uint64_t begin = offset + sizeof(std::uint32_t);
  if (name.size() > kLongest || begin + name.size() > file.size()) return false;
  file.read(begin, std::as_writable_bytes(std::span(name)));
  return std::ranges::all_of(name, [](unsigned char c) { return std::isgraph(c) != 0; });
}

/// Bytes of a body that the known fields take, by the lengths among them; nothing when they are more than there are.
/// For kinds that are large, or that lie between them.
std::optional<std::uint64_t> knownBytes(const InputFile& file, const RecordPlace& place) {
  const std::uint64_t body = place.offset + kRecordHeadBytes;
  std::uint64_t known = 0;
  const auto add = [&](std::uint64_t bytes) {
    const bool has_room = bytes <= place.body_length - known;
    if (has_room) known += bytes;
    return has_room;
  };
  const auto addSized = [&] { return add(4) && add(numberAt<std::uint32_t>(file, body + known - 4)); };
  const auto addLong = [&] { return add(8) && add(numberAt<std::uint64_t>(file, body + known - 8)); };
  bool is_sound = true;
  switch (place.opcode) {
    case Opcode::kChunk: {
      constexpr std::uint64_t kNameAt = 8 + 8 + 8 + 4;
      is_sound = isCompressionName(file, body + kNameAt) && add(kNameAt) && addSized() && addLong();
      break;
    }
    case Opcode::kMessageIndex:
      is_sound = numberAt<std::uint32_t>(file, body + 2) % sizeof(MessageIndex::Entry) == 0 && add(2) && addSized();
      break;
    case Opcode::kAttachment: is_sound = add(8 + 8) && addSized() && addSized() && addLong() && add(4); break;
    case Opcode::kMetadata: is_sound = addSized() && addSized(); break;
    default: known = place.body_length;
  }
  return is_sound ? std::optional(known) : std::nullopt;
}

/// Whether it can be a record of a known kind. @param is_exact  with nothing after its known fields.
bool isKnown(const InputFile& file, const RecordPlace& place, bool is_exact) {
  if (place.opcode == Opcode::kInvalid || place.opcode > Opcode::kDataEnd) return false;
  if (place.body_length < leastBytes(place.opcode)) return false;
  const std::optional<std::uint64_t> known = knownBytes(file, place);
  return known && (!is_exact || *known == place.body_length);
}

}  // namespace

bool beginsRecord(const InputFile& file, std::uint64_t offset, bool is_exact) {
  const RecordPlace place{.opcode = Opcode{static_cast<std::uint8_t>(numberAt<std::uint8_t>(file, offset))},
                          .offset = offset,
                          .body_length = numberAt<std::uint64_t>(file, offset + 1)};
  return place.body_length < file.size() && place.end() <= file.size() && isKnown(file, place, is_exact);
}

bool beginsIndex(const InputFile& file, std::uint64_t offset) {
  if (!beginsRecord(file, offset, false)) return false;
  switch (Opcode{static_cast<std::uint8_t>(numberAt<std::uint8_t>(file, offset))}) {
    case Opcode::kFooter:
    case Opcode::kSchema:
    case Opcode::kChannel:
    case Opcode::kStatistics:
    case Opcode::kChunkIndex:
    case Opcode::kAttachmentIndex:
    case Opcode::kMetadataIndex:
    case Opcode::kSummaryOffset: return true;
    default: return false;
  }
}

bool beginsWithHeader(const InputFile& file, std::uint64_t offset) {
  const std::uint64_t body = offset + kRecordHeadBytes, length = numberAt<std::uint64_t>(file, offset + 1);
  if (Opcode{static_cast<std::uint8_t>(numberAt<std::uint8_t>(file, offset))} != Opcode::kHeader) return false;
  return beginsRecord(file, offset, false) &&
         numberAt<std::uint32_t>(file, body) <= length - leastBytes(Opcode::kHeader) &&
         beginsRecord(file, body + length, false);
}

std::uint64_t zerosAt(const InputFile& file, std::uint64_t offset, std::uint64_t end) {
  constexpr std::uint64_t kBlockBytes = 16 << 10;
  Buffer storage;
  std::uint64_t at = offset;
  while (at < end) {
    const std::span<std::byte> block = storage.resize(static_cast<std::size_t>(std::min(kBlockBytes, end - at)));
    file.read(at, block);
    const auto other = std::ranges::find_if(block, [](std::byte one) { return one != std::byte{0}; });
    at += static_cast<std::uint64_t>(other - block.begin());
    if (other != block.end()) break;
  }
  return at - offset;
}

bool fits(const InputFile& file, const RecordPlace& place) {
  const std::optional<std::uint64_t> known = knownBytes(file, place);
  if (!known || *known == place.body_length) return known.has_value();
  if (place.end() != file.size() && !beginsRecord(file, place.end(), false)) return false;
  const std::uint64_t body = place.offset + kRecordHeadBytes, least = leastBytes(place.opcode);
  const bool is_zero = zerosAt(file, body, body + least) == least;  // its fields are damaged, and not its length
  return is_zero || !beginsRecord(file, body + *known, true);
}

bool isFollowed(const InputFile& file, const RecordPlace& place, const std::optional<RecordPlace>& next) {
  constexpr Opcode kFirstPrivate{0x80};
  if (next && next->opcode == Opcode::kHeader) return false;  // that of another recording
  // The last byte of the magic in front of that has the look of one.
  if (next && next->opcode == Opcode::kAttachmentIndex && hasMagic(file, place.end() + 1 - kMagic.size())) return false;
  if (next) return next->opcode >= kFirstPrivate || isKnown(file, *next, false);
  return place.end() == file.size() || hasMagic(file, place.end());
}

bool mayHoldRecording(const InputFile& file, std::uint64_t offset) {
  const Opcode opcode{static_cast<std::uint8_t>(numberAt<std::uint8_t>(file, offset))};
  if (opcode == Opcode::kInvalid || opcode > Opcode::kDataEnd) return true;
  if (opcode != Opcode::kAttachment) return false;
  const std::uint64_t name = offset + kRecordHeadBytes + 8 + 8;
  const std::uint64_t media_type = name + 4 + numberAt<std::uint32_t>(file, name);
  return hasMagic(file, media_type + 4 + numberAt<std::uint32_t>(file, media_type) + 8);
}

std::uint32_t crcOf(const InputFile& file, std::uint64_t begin, std::uint64_t end) {
  constexpr std::uint64_t kBlockBytes = 1 << 20;
  Buffer storage;
  std::uint32_t crc = 0;
  for (std::uint64_t offset = begin; offset < end; offset += kBlockBytes) {
    const std::span<std::byte> block = storage.resize(static_cast<std::size_t>(std::min(kBlockBytes, end - offset)));
    file.read(offset, block);
    crc = crc32(block, crc);
  }
  return crc;
}

bool hasMagic(const InputFile& file, std::uint64_t offset) {
  std::array<std::byte, kMagic.size()> magic{};
  if (offset <= file.size() && magic.size() <= file.size() - offset) file.read(offset, magic);
  return magic == kMagic;
}

bool beginsRecording(const InputFile& file, std::uint64_t offset) {
  return hasMagic(file, offset) &&
         Opcode{static_cast<std::uint8_t>(numberAt<std::uint8_t>(file, offset + kMagic.size()))} == Opcode::kHeader;
}

}  // namespace baton::mcap
