/// How a replay went, for people and for programs.
#pragma once

#include <string>

#include "options.hpp"
#include "replayer.hpp"

namespace baton {

[[nodiscard]] std::string summaryText(const ReplayResult& result, const ReplayOptions& options);
/// A JSON object; times in the units that keys end with. "rate" and "lateness_us" are null at the highest rate.
[[nodiscard]] std::string jsonText(const ReplayResult& result, const ReplayOptions& options);

}  // namespace baton
