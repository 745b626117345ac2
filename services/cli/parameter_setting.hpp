/// A parameter of a law as people type it.
#pragma once

#include <string>
#include <utility>

#include "control/parameters.hpp"

namespace baton {

/// "kp=300", "kp=[300, 300, 100]", "form=no_force": numbers where there are some, else a word; whether the parameter
/// wants them is for its law to say. Throws UsageError for another form.
[[nodiscard]] std::pair<std::string, ParameterValue> parseParameter(const std::string& setting);

}  // namespace baton
