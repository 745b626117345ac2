/// The raw chain as processes: forks one a role, lets them find each other and runs it.
#pragma once

#include "raw_roles.hpp"

namespace raw {

/// Prints how long the steps took, as JSON, on standard output. Throws std::runtime_error when a process fails or the
/// chain does not get on. To be called before this process has threads.
void runChain(const Chain& chain);

}  // namespace raw
