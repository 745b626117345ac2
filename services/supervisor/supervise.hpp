/// The supervisor's whole main: command line, the lock on the cell, the run.
#pragma once

#include "base/error.hpp"

namespace baton {

[[nodiscard]] ExitCode supervise(int argc, char** argv);

}  // namespace baton
