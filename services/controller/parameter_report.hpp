/// The parameters a controller runs with, as others see them: each value beside what the law's declaration says of it.
#pragma once

#include "msg/parameter.h"
#include "runtime/scenario.hpp"

namespace baton {

/// Throws UsageError when the declaration of a law has more, or longer words, than the message can carry.
[[nodiscard]] msg::ParameterStatus parameterReport(const ControllerConfig& config);

}  // namespace baton
