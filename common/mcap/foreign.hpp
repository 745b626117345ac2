/// What is in a file that belongs to no recording: bytes before, between and behind recordings, and files that are
/// none.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mcap/index.hpp"

namespace baton::mcap {

/// Where the first recording in the file begins. Throws FormatError, which says what the file is, when there is none.
/// A Header tells of one whose first bytes are damaged, so that none of its attachments is taken for it.
[[nodiscard]] std::uint64_t firstRecording(const InputFile& file);

/// Bytes that belong to no recording, in front of the first one or behind the end of one.
[[nodiscard]] Damage foreignBytes(const InputFile& file, std::uint64_t offset, std::uint64_t length);

/// All of them in a sentence; empty when there are none.
[[nodiscard]] std::string describeForeign(const std::vector<Damage>& foreign);

}  // namespace baton::mcap
