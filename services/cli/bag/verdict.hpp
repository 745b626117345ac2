/// What `bag info` and `bag verify` come to.
#pragma once

#include "base/error.hpp"

namespace baton {

enum class RecordingVerdict {
  kComplete,    // finished, and nothing is missing
  kIncomplete,  // finished, but messages are missing, or nobody says that none are
  kCut,         // ends in the middle
  kDamaged      // parts of it cannot be read
};

[[nodiscard]] inline ExitCode exitCodeOf(RecordingVerdict verdict) {
  switch (verdict) {
    case RecordingVerdict::kComplete: return ExitCode::kOk;
    case RecordingVerdict::kIncomplete:
    case RecordingVerdict::kCut: return ExitCode::kFailed;
    case RecordingVerdict::kDamaged: return ExitCode::kUsage;
  }
  return ExitCode::kUsage;
}

[[nodiscard]] inline const char* nameOf(RecordingVerdict verdict) {
  switch (verdict) {
    case RecordingVerdict::kComplete: return "complete";
    case RecordingVerdict::kIncomplete: return "incomplete";
    case RecordingVerdict::kCut: return "cut";
    case RecordingVerdict::kDamaged: return "damaged";
  }
  return "";
}

}  // namespace baton
