/// What a recording says about the run it is of.
#pragma once

#include "recording.hpp"
#include "runtime/service_options.hpp"

namespace baton {

/// Versions, hash of the IDL, host, when it was begun: what every recording says of the program that made it.
[[nodiscard]] mcap::StringMap factsOfProgram();

/// Scenario, robot, versions, hash of the IDL, seeds, host: strings by name; and scenario, robot and checkpoint as
/// files.
[[nodiscard]] Origin originOf(const ServiceOptions& options, const Scenario& scenario);

}  // namespace baton
