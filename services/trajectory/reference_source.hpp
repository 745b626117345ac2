/// On PlantState(k): Reference(k + 1), so that it waits for the controllers and not they for it. The first state seen
/// is also answered with its own reference, which nobody could have sent before.
#pragma once

#include "runtime/loop_output.hpp"
#include "runtime/service.hpp"
#include "runtime/step_answers.hpp"

namespace baton {

class ReferenceSource {
 public:
  explicit ReferenceSource(Service& service);

 private:
  void onState(const msg::PlantState& message);
  void publish(std::uint64_t step);

  Service& service_;
  ReferenceAnswer answer_;
  LoopOutput<msg::Reference> reference_out_;
  msg::Reference message_;
  std::optional<std::uint64_t> answered_;  // the last state
};

}  // namespace baton
