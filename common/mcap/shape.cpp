#include "mcap/shape.hpp"

#include <optional>

namespace baton::mcap {
namespace {

/// The least that a record's body holds.
std::uint64_t leastBytes(Opcode opcode) {
  switch (opcode) {
    case Opcode::kHeader: return 4 + 4;
    case Opcode::kFooter: return 8 + 8 + 4;
    case Opcode::kSchema: return 2 + 4 + 4 + 4;
    case Opcode::kChannel: return 2 + 2 + 4 + 4 + 4;
    case Opcode::kMessage: return 2 + 4 + 8 + 8;
    case Opcode::kChunk: return 8 + 8 + 8 + 4 + 4 + 8;
    case Opcode::kMessageIndex: return 2 + 4;
    case Opcode::kChunkIndex: return 8 + 8 + 8 + 8 + 4 + 8 + 4 + 8 + 8;
    case Opcode::kAttachment: return 8 + 8 + 4 + 4 + 8 + 4;
    case Opcode::kAttachmentIndex: return 8 + 8 + 8 + 8 + 8 + 4 + 4;
    case Opcode::kStatistics: return 8 + 2 + 4 + 4 + 4 + 4 + 8 + 8 + 4;
    case Opcode::kMetadata: return 4 + 4;
    case Opcode::kMetadataIndex: return 8 + 8 + 4;
    case Opcode::kSummaryOffset: return 1 + 8 + 8;
    case Opcode::kDataEnd: return 4;
    default: return 0;
  }
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
      constexpr std::uint64_t kNameAt = 8 + 8 + 8 + 4, kLongestName = 4;
      is_sound =
          numberAt<std::uint32_t>(file, body + kNameAt) <= kLongestName && add(kNameAt) && addSized() && addLong();
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

/// Whether a record of a known kind lies there, whole. @param is_exact  with nothing after its known fields.
bool beginsRecord(const InputFile& file, std::uint64_t offset, bool is_exact) {
  const RecordPlace place{.opcode = Opcode{static_cast<std::uint8_t>(numberAt<std::uint8_t>(file, offset))},
                          .offset = offset,
                          .body_length = numberAt<std::uint64_t>(file, offset + 1)};
  if (place.opcode == Opcode::kInvalid || place.opcode > Opcode::kDataEnd) return false;
  if (place.body_length < leastBytes(place.opcode) || place.body_length >= file.size()) return false;
  const std::optional<std::uint64_t> known = knownBytes(file, place);
  return place.end() <= file.size() && known && (!is_exact || *known == place.body_length);
}

}  // namespace

bool fits(const InputFile& file, const RecordPlace& place) {
  const std::optional<std::uint64_t> known = knownBytes(file, place);
  if (!known || *known == place.body_length) return known.has_value();
  return (place.end() == file.size() || beginsRecord(file, place.end(), false)) &&
         !beginsRecord(file, place.offset + kRecordHeadBytes + *known, true);
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
