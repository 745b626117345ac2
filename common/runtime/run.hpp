/// The one place where errors become messages and exit codes.
#pragma once

#include <functional>
#include <string>

#include "base/error.hpp"
#include "runtime/service.hpp"

namespace baton {

/// Runs `body`; what it throws is printed to standard error after `name` and becomes the exit code.
[[nodiscard]] int runGuarded(const std::string& name, const std::function<ExitCode()>& body);

/// A service's whole main: command line, scenario, log, DDS; then `body`, which sets up its topics and calls run().
[[nodiscard]] int runService(int argc, char** argv, const std::string& role,
                             const std::function<ExitCode(Service&)>& body);

}  // namespace baton
