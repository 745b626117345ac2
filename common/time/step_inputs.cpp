#include "time/step_inputs.hpp"

namespace baton {

bool StepInputs::wants(std::size_t index, std::uint64_t step) const noexcept {
  if (last_done_ && step <= *last_done_) return false;
  const std::optional<std::uint64_t>& held = arrived_[index][slot(step)];
  return !held || *held < step;
}

bool StepInputs::offer(std::size_t index, std::uint64_t step) noexcept {
  if (!wants(index, step)) return false;
  arrived_[index][slot(step)] = step;
  for (std::size_t i = 0; i < inputs_; ++i) {
    if (arrived_[i][slot(step)] != step) return false;
  }
  return true;
}

}  // namespace baton
