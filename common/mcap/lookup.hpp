/// What is asked of many a recording, in a line each.
#pragma once

#include <string>
#include <vector>

#include "mcap/reader.hpp"

namespace baton::mcap {

/// Empty when the map has no such key.
[[nodiscard]] std::string valueOf(const StringMap& map, const std::string& key);

/// All topics of a recording, sorted.
[[nodiscard]] std::vector<std::string> topicNames(const Reader& reader);

/// From its first message to its last, in s of log time.
[[nodiscard]] double durationOf(const Reader& reader);

/// A log time from the recording's first message on; the latest there is, when that is beyond it.
/// @param seconds  not negative.
[[nodiscard]] std::uint64_t logTimeAt(const Reader& reader, double seconds);

}  // namespace baton::mcap
