/// The names of a recording that is split: run.mcap, run_0001.mcap, run_0002.mcap, ... side by side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace baton {

/// Index 0 is the recording's own name.
[[nodiscard]] std::filesystem::path partOf(const std::filesystem::path& recording, unsigned index);

/// The parts behind the first one that are there, in order.
[[nodiscard]] std::vector<std::filesystem::path> furtherPartsOf(const std::filesystem::path& recording);

/// The absolute path of a recording that is to be made where a person says. With `overwrite` what is there of an
/// earlier one is removed: the file and, when it is to be split, its other parts. Throws, with the name of the option
/// that gave the path, UsageError when it cannot be made, something else is in the way, or it is one of the files that
/// are read meanwhile; and UnavailableError when it is there and may not be replaced.
[[nodiscard]] std::filesystem::path claimRecording(const std::string& option, const std::string& out, bool is_split,
                                                   bool overwrite,
                                                   const std::vector<std::filesystem::path>& reads = {});

}  // namespace baton
