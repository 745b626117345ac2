#include "highest_rate.hpp"

namespace baton::bench {
namespace {

constexpr double kStep = 1.25;
constexpr double kLowest = 0.1;  // of the rate asked for

}  // namespace

Climb climb(double rate, double up_to, const MeasureRate& measure) {
  Climb result;
  const auto isKept = [&](double one) {
    result.measured.push_back(measure(one));
    if (!result.measured.back().isKept()) {
      result.is_loss_above = result.measured.back().lost() > 0;
      return false;
    }
    result.highest = one;
    return true;
  };
  if (isKept(rate)) {
    for (double next = rate * kStep; next <= up_to && isKept(next);) next *= kStep;
  } else {
    for (double next = rate / kStep; next >= kLowest * rate && !isKept(next);) next /= kStep;
  }
  return result;
}

}  // namespace baton::bench
