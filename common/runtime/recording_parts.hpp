/// The names of a recording that is split: run.mcap, run_0001.mcap, run_0002.mcap, ... side by side.
#pragma once

#include <filesystem>
#include <vector>

namespace baton {

/// Index 0 is the recording's own name.
[[nodiscard]] std::filesystem::path partOf(const std::filesystem::path& recording, unsigned index);

/// The parts behind the first one that are there, in order.
[[nodiscard]] std::vector<std::filesystem::path> furtherPartsOf(const std::filesystem::path& recording);

}  // namespace baton
