/// Counts in sentences.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace baton {

/// "1 message", "2 messages".
[[nodiscard]] inline std::string counted(std::uint64_t count, std::string_view what) {
  return std::to_string(count).append(" ").append(what).append(count == 1 ? "" : "s");
}

/// The verb that goes with it.
[[nodiscard]] inline const char* areOrIs(std::uint64_t count) { return count == 1 ? "is" : "are"; }

}  // namespace baton
