/// The parameters a controller runs with, as others see them: each value beside what the law's declaration says of it.
#pragma once

#include "control/law.hpp"
#include "msg/parameter.h"
#include "runtime/scenario.hpp"

namespace baton {

/// Of a controller as the scenario has it. Throws UsageError when the declaration of a law has more, or longer words,
/// than the message can carry.
[[nodiscard]] msg::ParameterStatus parameterReport(const ControllerConfig& config);

/// Other values into the report of a controller with that law. Allocates nothing.
void fill(const LawInfo& law, const ParameterValues& values, msg::ParameterStatus& report);

}  // namespace baton
