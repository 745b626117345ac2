/// How a replay went, for people and for programs.
#pragma once

#include <string>

#include "options.hpp"
#include "replayer.hpp"

namespace baton {

[[nodiscard]] std::string summaryText(const ReplayResult& result, const ReplayOptions& options);
/// A JSON object; times in the units that keys end with. "rate" is the one asked for at the start, null for the
/// highest; "lateness_us" and "overdue" are null when no message had a time to go out at.
[[nodiscard]] std::string jsonText(const ReplayResult& result, const ReplayOptions& options);

}  // namespace baton
