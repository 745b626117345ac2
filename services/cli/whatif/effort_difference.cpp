#include "effort_difference.hpp"

#include <cmath>
#include <cstring>

namespace baton {

void EffortDifference::add(std::uint64_t step, const JointVector& effort, const JointVector& recorded) {
  const auto n = static_cast<std::size_t>(effort.size());
  joints_.resize(n);
  ++steps_;
  if (std::memcmp(effort.data(), recorded.data(), n * sizeof(double)) != 0) {  // -0.0 is not 0.0
    ++different_steps_;
    if (!first_different_step_) first_different_step_ = step;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double difference = effort(row) - recorded(row);
    joints_[i].sum_of_squares += difference * difference;
    if (!(std::abs(difference) > joints_[i].largest)) continue;
    joints_[i].largest = std::abs(difference);
    joints_[i].largest_at_step = step;
  }
}

double EffortDifference::rms(std::size_t joint) const {
  return std::sqrt(joints_.at(joint).sum_of_squares / static_cast<double>(steps_));
}

}  // namespace baton
