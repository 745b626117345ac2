/// What is asked of many a recording, in a line each.
#pragma once

#include <string>
#include <vector>

#include "mcap/source.hpp"

namespace baton::mcap {

/// Empty when the map has no such key.
[[nodiscard]] std::string valueOf(const StringMap& map, const std::string& key);

/// Why a recording is not complete; empty when it is.
[[nodiscard]] std::string incompletenessOf(const FileInfo& info);

/// All topics of a recording, sorted.
[[nodiscard]] std::vector<std::string> topicNames(const Source& reader);

/// From its first message to its last, in s of log time.
[[nodiscard]] double durationOf(const Source& reader);

/// A log time from the recording's first message on; the latest there is, when that is beyond it.
/// @param seconds  not negative.
[[nodiscard]] std::uint64_t logTimeAt(const Source& reader, double seconds);

}  // namespace baton::mcap
