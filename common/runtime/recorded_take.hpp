/// The take of a run that counts: of a run that was reset, what was after its last reset.
#pragma once

#include <cstdint>

#include "mcap/source.hpp"

namespace baton {

/// The last take of a run: how often it has been reset before, and the log time from which on everything belongs to it;
/// 0 when it never was. Where the topic that announces a reset was left out, a take begins where the steps of the
/// states go back.
struct Take {
  std::uint32_t number = 0;
  std::uint64_t begin_ns = 0;
};
[[nodiscard]] Take lastTake(const mcap::Source& reader);
/// Where it begins.
[[nodiscard]] std::uint64_t lastTakeBegin(const mcap::Source& reader);

}  // namespace baton
