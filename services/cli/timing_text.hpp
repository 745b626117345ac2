/// The timing of a run for a person to read.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace baton {

/// From the "timing" of a result or a status: one sentence about the steps and, in realtime, one about how late they
/// ended and how old their torques were. Empty when no step has been timed.
[[nodiscard]] std::string timingText(const nlohmann::ordered_json& timing);

}  // namespace baton
