/// The numbers of a loop message that a faulty sensor or law would get wrong.
#pragma once

#include <span>

#include "msg/loop.h"

namespace baton {

/// The measured joint positions [rad or m].
[[nodiscard]] inline std::span<double> valuesOf(msg::PlantState& message) { return message.position(); }
/// The measured force [N].
[[nodiscard]] inline std::span<double> valuesOf(msg::Contact& message) { return message.force(); }
/// The desired joint positions [rad or m], or the tip's [m] when the motion is given in task space alone.
[[nodiscard]] inline std::span<double> valuesOf(msg::Reference& message) {
  if (message.position().empty()) return message.tip_position();
  return message.position();
}
/// The efforts [N m or N].
[[nodiscard]] inline std::span<double> valuesOf(msg::JointCommand& message) { return message.effort(); }

}  // namespace baton
