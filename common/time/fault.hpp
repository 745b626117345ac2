/// What a scenario lets go wrong on purpose: when, where, what. Whether a fault strikes at a step depends on the
/// scenario and the step alone, so every run of it suffers the same.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace baton {

enum class FaultKind {
  // what a message says
  kNan,    // its numbers are not
  kStuck,  // its numbers are those from before the fault
  kBias,   // `by` is added to its numbers
  // whether and when it comes
  kDrop,
  kDuplicate,
  kDelay,  // by seconds of real time
  // the process
  kStop,  // as by SIGSTOP, for seconds of real time, or for good
  kKill,  // as by SIGKILL
};

struct Fault {
  FaultKind kind = FaultKind::kDrop;
  std::string service;           // at fault
  std::string topic;             // of the message; empty: the process
  std::uint64_t from_step = 1;   // a process is struck when it reaches it, once
  std::uint64_t until_step = 2;  // first step that is spared again
  double probability = 1.0;      // at each step
  std::uint64_t seed = 0;        // other steps for the same probability
  std::vector<double> by;        // kBias: one number each, or one for all
  double seconds = 0.0;          // kDelay, kStop; kStop: 0 for good
};

[[nodiscard]] inline bool isOfProcess(FaultKind kind) { return kind == FaultKind::kStop || kind == FaultKind::kKill; }
[[nodiscard]] inline bool isOfValues(FaultKind kind) {
  return kind == FaultKind::kNan || kind == FaultKind::kStuck || kind == FaultKind::kBias;
}
[[nodiscard]] const char* toString(FaultKind kind);  // as scenarios call it

[[nodiscard]] bool strikes(const Fault& fault, std::uint64_t step) noexcept;

}  // namespace baton
