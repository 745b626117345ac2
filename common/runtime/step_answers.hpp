/// What environment and trajectory answer to a step, message to message. Their services send it over DDS, a
/// MonolithicRun takes it as it is: one code, so that both have the same bytes.
#pragma once

#include "messages/loop.hpp"
#include "runtime/scenario.hpp"

namespace baton {

/// Contact(k) on PlantState(k): the sum over all walls.
class ContactAnswer {
 public:
  explicit ContactAnswer(const Scenario& scenario) : walls_(scenario.walls), joints_(scenario.robot.size()) {}

  /// Nothing is answered to a state that is not one of this robot.
  [[nodiscard]] Reading operator()(const msg::PlantState& state, msg::Contact& contact);

 private:
  std::vector<PlaneSpec> walls_;
  int joints_;
  RobotState state_;
};

/// Reference(k), which depends on nothing but the time.
class ReferenceAnswer {
 public:
  explicit ReferenceAnswer(const Scenario& scenario)
      : trajectory_(scenario.robot, scenario.trajectory), step_ns_(scenario.step_ns) {}

  void operator()(std::uint64_t step, msg::Reference& message);

 private:
  Trajectory trajectory_;
  std::int64_t step_ns_;
  Reference reference_;
};

}  // namespace baton
