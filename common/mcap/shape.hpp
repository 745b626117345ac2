/// Whether bytes of a file have the shape of a record: where reading can continue after damage.
#pragma once

#include <optional>

#include "mcap/index.hpp"

namespace baton::mcap {

/// A number in the file; 0 after its end.
template <std::unsigned_integral Number>
[[nodiscard]] std::uint64_t numberAt(const InputFile& file, std::uint64_t offset) {
  Number value = 0;
  if (offset <= file.size() && sizeof value <= file.size() - offset) {
    file.read(offset, std::as_writable_bytes(std::span(&value, 1)));
  }
  return value;
}

/// How many zero bytes there are from there on, before `end`.
[[nodiscard]] std::uint64_t zerosAt(const InputFile& file, std::uint64_t offset, std::uint64_t end);

/// Whether a record of a known kind lies there, whole. @param is_exact  with nothing after its known fields.
[[nodiscard]] bool beginsRecord(const InputFile& file, std::uint64_t offset, bool is_exact);

/// Whether that is a record of what follows the data, or the footer.
[[nodiscard]] bool beginsIndex(const InputFile& file, std::uint64_t offset);

/// Whether a Header lies there, and another record behind it.
[[nodiscard]] bool beginsWithHeader(const InputFile& file, std::uint64_t offset);

/// Whether the lengths in the record there fit one another. That is more than chance gives, so it also distinguishes
/// such a record from other bytes. A later version of the format may have added fields to a record: then another one
/// follows its end. Where one follows its known fields, it is the record's own length that is damaged.
[[nodiscard]] bool fits(const InputFile& file, const RecordPlace& place);

/// Whether something follows the record that can follow one: another, the magic, or the end of the file.
/// @param next  what has a record's head there.
[[nodiscard]] bool isFollowed(const InputFile& file, const RecordPlace& place, const std::optional<RecordPlace>& next);

/// Whether a recording may lie in the record there, in front of anything that follows it: not in one of a kind that
/// holds none, nor in an attachment that begins otherwise.
[[nodiscard]] bool mayHoldRecording(const InputFile& file, std::uint64_t offset);

/// The CRC-32 of the bytes from `begin` up to `end`, read in pieces.
[[nodiscard]] std::uint32_t crcOf(const InputFile& file, std::uint64_t begin, std::uint64_t end);

[[nodiscard]] bool hasMagic(const InputFile& file, std::uint64_t offset);

/// The magic and a Header: recordings that were joined end to end in one file.
[[nodiscard]] bool beginsRecording(const InputFile& file, std::uint64_t offset);

}  // namespace baton::mcap
