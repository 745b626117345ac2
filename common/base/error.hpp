/// The errors a person causes or meets, thrown at the edges (files, command lines, DDS entities) and caught once, in
/// runtime/run.hpp, which prints the message and exits with the code. Nothing in the control loop throws.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace baton {

/// The exit codes of every Baton program; README.md documents them.
enum class ExitCode : int {
  kOk = 0,
  kFailed = 1,        // the thing asked for was tried and did not succeed
  kUsage = 2,         // the command line, a file or a value given is wrong
  kUnavailable = 3,   // something needed is missing or taken: no such run, cell in use, port closed
  kAborted = 4,       // a run was stopped before its end by its own policy
  kInterrupted = 130  // by a signal that asks for the end: common/runtime/signals.hpp
};

/// The message says what was expected, what was found, and what to do. It is shown as one line; `details` are lines
/// that follow it, as the end of a log.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message, std::string details = "")
      : std::runtime_error(message), code_(code), details_(std::move(details)) {}
  [[nodiscard]] ExitCode code() const { return code_; }
  [[nodiscard]] const std::string& details() const { return details_; }

 private:
  ExitCode code_;
  std::string details_;
};

/// Wrong input: a file, a value, an argument.
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ExitCode::kUsage, message) {}
};

/// Something needed is not there or is taken.
class UnavailableError : public Error {
 public:
  explicit UnavailableError(const std::string& message, std::string details = "")
      : Error(ExitCode::kUnavailable, message, std::move(details)) {}
};

}  // namespace baton
