/// Which programs these are, down to the byte: two builds that differ in a law's sign have the same version.
#pragma once

#include <string>

namespace baton {

/// A hash of the programs that compute the loop, 16 hexadecimal digits. Throws UnavailableError when one is missing.
[[nodiscard]] std::string buildId();

}  // namespace baton
