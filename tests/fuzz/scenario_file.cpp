// Fuzz target: a scenario, a zero, a robot file; both as people write them. A robot file alone is read too. What is
// refused is refused by a UsageError that names the file.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "base/error.hpp"
#include "runtime/scenario.hpp"

namespace {

using namespace baton;

void require(bool holds) {
  if (!holds) std::abort();
}

template <class Read>
void tryTo(const Read& read) {
  try {
    read();
  } catch (const UsageError& error) {
    require(std::string(error.what()).find(".yaml") != std::string::npos);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(input.find('\0'), input.size());
  const std::string scenario_text = input.substr(0, end), robot_text = input.substr(std::min(end + 1, input.size()));
  tryTo([&] {
    const RobotModel robot = parseRobot("robot.yaml", robot_text);
    require(robot.size() > 0 && robot.size() <= kMaxJoints);
  });
  tryTo([&] {
    const Scenario scenario = parseScenario("scenario.yaml", scenario_text, "robot.yaml", robot_text);
    require(scenario.step_ns > 0 && scenario.armConfig().start_q.size() == scenario.robot.size());
    (void)scenario.controller(scenario.active);
  });
  return 0;
}
