/// How far one effort is from another over the steps of a run, joint by joint.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/types.hpp"

namespace baton {

class EffortDifference {
 public:
  struct Joint {
    double sum_of_squares = 0.0;
    double largest = 0.0;  // of the absolute differences [N m or N]
    std::uint64_t largest_at_step = 0;
  };

  /// Efforts of the same size, as at every step.
  void add(std::uint64_t step, const JointVector& effort, const JointVector& recorded);

  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  /// All efforts are the same to the bit, and there are some.
  [[nodiscard]] bool isExact() const { return steps_ > 0 && !first_different_step_; }
  [[nodiscard]] std::uint64_t differentSteps() const { return different_steps_; }
  [[nodiscard]] std::optional<std::uint64_t> firstDifferentStep() const { return first_different_step_; }
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }
  /// Root of the mean square over the steps; NaN without any.
  [[nodiscard]] double rms(std::size_t joint) const;

 private:
  std::uint64_t steps_ = 0;
  std::uint64_t different_steps_ = 0;
  std::optional<std::uint64_t> first_different_step_;
  std::vector<Joint> joints_;
};

}  // namespace baton
