/// What a run was made with, in a line for people: law, gains, step, limits, noise.
#pragma once

#include <string>

#include "runtime/scenario.hpp"

namespace baton {

[[nodiscard]] std::string settingsText(const Scenario& scenario);

}  // namespace baton
