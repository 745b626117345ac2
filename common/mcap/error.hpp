/// What can go wrong with a recording, beside a wrong argument (UsageError) and a missing or taken file
/// (UnavailableError).
#pragma once

#include "base/error.hpp"

namespace baton::mcap {

/// The bytes are not what MCAP says they should be: not a recording, or a damaged one.
class FormatError : public UsageError {
 public:
  using UsageError::UsageError;
};

/// Nothing in it is MCAP.
class NotARecording : public FormatError {
 public:
  using FormatError::FormatError;
};

/// The operating system did not take the bytes: disk full, file size limit, input/output error. The message names the
/// file, how many bytes of how many went in, and where.
class WriteError : public Error {
 public:
  explicit WriteError(const std::string& message) : Error(ExitCode::kFailed, message) {}
};

}  // namespace baton::mcap
