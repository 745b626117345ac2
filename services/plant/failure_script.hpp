/// The failures that a scenario plans, in the order in which they take effect. A plain list with a place in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/scenario.hpp"

namespace baton {

class FailureScript {
 public:
  struct Event {
    std::uint64_t step = 0;  // at which it takes effect
    int member = 0;
    bool returns = false;    // it stands by again; else it fails
    bool commanded = false;  // fails: after its command for that step, if the step needs one of it
    bool restarted = false;  // returns: as a new process
  };

  /// @param names  the controllers, by member.
  FailureScript(const std::vector<PlannedFailure>& failures, const std::vector<std::string>& names);

  /// From a run's first step on. Returns who has failed before it.
  std::vector<int> begin(std::uint64_t first_step);
  /// What takes effect at this step, or should have before: one by one, then nothing.
  [[nodiscard]] std::optional<Event> next(std::uint64_t step);

 private:
  std::vector<int> absent_;    // before step 0
  std::vector<Event> events_;  // by step
  std::size_t next_ = 0;
};

}  // namespace baton
