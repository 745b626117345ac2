/// The libraries and the processor of this process. A recording keeps those of its recorder, so that a repetition with
/// other bytes can name a likely cause.
#pragma once

#include <map>
#include <string>

namespace baton {

/// By key: "mathematics", "libc", "dds", "processor"; as in {"mathematics", "SLEEF 3.5.1, Eigen 3.4.0"}.
[[nodiscard]] std::map<std::string, std::string> platform();

/// The processor's own name, else its architecture.
[[nodiscard]] std::string processorName();

}  // namespace baton
