/// What `bag info` and `bag verify` come to.
#pragma once

#include "base/error.hpp"

namespace baton {

enum class Verdict {
  kComplete,    // finished, and nothing is missing
  kIncomplete,  // finished, but messages are missing, or nobody says that none are
  kCut,         // ends in the middle
  kDamaged      // parts of it cannot be read
};

[[nodiscard]] inline ExitCode exitCodeOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kComplete: return ExitCode::kOk;
    case Verdict::kIncomplete:
    case Verdict::kCut: return ExitCode::kFailed;
    case Verdict::kDamaged: return ExitCode::kUsage;
  }
  return ExitCode::kUsage;
}

[[nodiscard]] inline const char* nameOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kComplete: return "complete";
    case Verdict::kIncomplete: return "incomplete";
    case Verdict::kCut: return "cut";
    case Verdict::kDamaged: return "damaged";
  }
  return "";
}

}  // namespace baton
