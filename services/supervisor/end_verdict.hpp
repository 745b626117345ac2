/// What the end of a part says once the run is over.
#pragma once

#include <signal.h>

#include "runtime/child.hpp"

namespace baton {

enum class EndVerdict {
  kInOrder,
  kDied,        // before it was told to end, of which word came late; or instead of ending
  kIncomplete,  // the recorder, whose file is not whole then
};

/// @param is_told    it had been sent SIGTERM, which may come before it listens.
/// @param is_killed  we sent SIGKILL to whoever did not end in time.
[[nodiscard]] inline EndVerdict endVerdict(const Child::End& end, bool is_recorder, bool is_told, bool is_killed) {
  const bool is_whole = !end.by_signal && end.value == 0;
  if (is_recorder) return is_whole ? EndVerdict::kInOrder : EndVerdict::kIncomplete;
  const bool is_ours = end.by_signal && ((end.value == SIGTERM && is_told) || (end.value == SIGKILL && is_killed));
  return is_whole || is_ours ? EndVerdict::kInOrder : EndVerdict::kDied;
}

}  // namespace baton
