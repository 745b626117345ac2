/// How much the recorder takes: the highest rate at which nothing is lost.
#pragma once

#include <functional>
#include <vector>

#include "load.hpp"

namespace baton::bench {

using MeasureRate = std::function<Recorded(double rate)>;

/// One way up, or down. The first of its measurements is the one at the rate that was asked for.
struct Climb {
  std::vector<Recorded> measured;
  double highest = 0.0;        // messages a second at which nothing was lost; 0: there was none
  bool is_loss_above = false;  // else the writers could not send more, or nobody asked for more
};

/// From `rate` upwards by a quarter at a time, until something is lost, the writers do not keep up, or `up_to` is
/// passed; where `rate` itself is too much, downwards, at most to a tenth.
[[nodiscard]] Climb climb(double rate, double up_to, const MeasureRate& measure);

}  // namespace baton::bench
