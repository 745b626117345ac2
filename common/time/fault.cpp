#include "time/fault.hpp"

#include "base/splitmix64.hpp"

namespace baton {
namespace {

/// In [0, 1).
double uniform(std::uint64_t seed, std::uint64_t step) noexcept {
  const std::uint64_t stream = splitmix(seed + kSplitmixStep);
  return static_cast<double>(splitmix((stream ^ step) + kSplitmixStep) >> 11) * 0x1.0p-53;
}

}  // namespace

const char* toString(FaultKind kind) {
  switch (kind) {
    case FaultKind::kNan: return "nan";
    case FaultKind::kStuck: return "stuck";
    case FaultKind::kBias: return "bias";
    case FaultKind::kDrop: return "drop";
    case FaultKind::kDuplicate: return "duplicate";
    case FaultKind::kDelay: return "delay";
    case FaultKind::kStop: return "stop";
    case FaultKind::kKill: return "kill";
  }
  return "?";
}

bool strikes(const Fault& fault, std::uint64_t step) noexcept {
  return step >= fault.from_step && step < fault.until_step && uniform(fault.seed, step) < fault.probability;
}

}  // namespace baton
