/// On PlantState(k): Contact(k), the sum over all walls.
#pragma once

#include "runtime/loop_output.hpp"
#include "runtime/service.hpp"
#include "runtime/step_answers.hpp"

namespace baton {

class WallResponder {
 public:
  explicit WallResponder(Service& service);

 private:
  void onState(const msg::PlantState& message);

  Service& service_;
  LoopOutput<msg::Contact> contact_out_;
  ContactAnswer answer_;
  msg::Contact message_;
  std::optional<std::uint64_t> answered_;  // the last state
};

}  // namespace baton
