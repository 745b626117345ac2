/// What a recording says about the run it is of, as MCAP metadata.
#pragma once

#include "mcap/records.hpp"
#include "runtime/service_options.hpp"

namespace baton {

/// Scenario, robot, versions, hash of the IDL, host: strings by name.
[[nodiscard]] mcap::StringMap runManifest(const ServiceOptions& options, const Scenario& scenario);

}  // namespace baton
