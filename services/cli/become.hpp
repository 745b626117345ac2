/// Commands that are programs: this process becomes one of them, which so has its signals and its exit code.
#pragma once

#include <string>
#include <vector>

namespace baton {

/// @param program    as in "baton-replayer".
/// @param arguments  the first is what it calls itself in its help.
/// Throws UnavailableError when it cannot be started; does not return otherwise.
[[noreturn]] void become(const std::string& program, std::vector<std::string> arguments);

}  // namespace baton
