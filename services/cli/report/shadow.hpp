/// What each controller of a run would have done: its efforts, in shadow, beside those that moved the arm.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "efforts.hpp"
#include "plot.hpp"

namespace baton {

/// A joint's effort from a controller that stood by, and the steps at which it was largest. NaN where it never computed
/// while it stood by.
struct ShadowJoint {
  std::string name;  // "tau1"
  std::string unit;
  double rms = 0.0;      // of effort(k) - what the joint felt over step k
  double largest = 0.0;  // of its absolute values
  std::uint64_t largest_at_step = 0;
  double jump =
      0.0;  // largest |effort(k) - what the joint felt over step k - 1|: had it taken over there, without help
  std::uint64_t jump_at_step = 0;
  double last_jump = 0.0;  // with its sign, at the last step for which it is known
};

struct ShadowController {
  std::string name;
  std::string law;
  double held = 0.0;    // part of the steps in which it held the baton
  double silent = 0.0;  // part of the steps for which it has no effort
  std::vector<ShadowJoint> joints;
};

struct Shadow {
  std::uint64_t steps = 0;  // that have ended
  double duration_s = 0.0;
  double step_s = 0.0;
  std::string cut;       // as in RecordedEfforts
  bool is_cold = false;  // who stood by did not compute
  std::vector<ShadowController> controllers;
};

[[nodiscard]] Shadow shadowOf(const RecordedEfforts& run);

[[nodiscard]] nlohmann::ordered_json toJson(const Shadow& shadow);
/// A table to be read.
[[nodiscard]] std::string toText(const Shadow& shadow);

/// One panel a joint: what each controller commanded or would have, and what the joint felt. The curves point to `run`.
[[nodiscard]] std::vector<Panel> shadowPanels(const RecordedEfforts& run);

}  // namespace baton
