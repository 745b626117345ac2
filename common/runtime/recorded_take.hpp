/// The take of a run that counts: of a run that was reset, what was after its last reset.
#pragma once

#include <cstdint>

#include "mcap/source.hpp"

namespace baton {

/// The last take of a run, and the log time from which on everything belongs to it; 0 when it never was reset. Where
/// the topic that announces a reset was left out, or may have been, as nothing says what was recorded, a take begins
/// where the steps of the states go back.
struct Take {
  std::uint32_t number = 0;  // as in its messages: resets that were called off are counted
  std::uint64_t begin_ns = 0;
  std::uint32_t resets = 0;  // before it, that the recording knows of
};
/// Throws UsageError when messages of several runs are in it, as where files were merged or one behind the other.
[[nodiscard]] Take lastTake(const mcap::Source& reader);
/// Resets in it, of whatever runs.
[[nodiscard]] std::uint32_t resetsIn(const mcap::Source& reader);
/// Where it begins.
[[nodiscard]] std::uint64_t lastTakeBegin(const mcap::Source& reader);

}  // namespace baton
