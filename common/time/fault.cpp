#include "time/fault.hpp"

namespace baton {
namespace {

/// SplitMix64 (Steele, Lea, Flood 2014): neighbouring inputs give unrelated outputs.
std::uint64_t mixed(std::uint64_t x) noexcept {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// In [0, 1).
double uniform(std::uint64_t seed, std::uint64_t step) noexcept {
  return static_cast<double>(mixed(mixed(seed) ^ step) >> 11) * 0x1.0p-53;
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
