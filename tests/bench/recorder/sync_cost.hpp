/// What it costs a whole run, as fast as it goes, that its recording is brought to the storage device.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "programs.hpp"

namespace baton::bench {

/// `recording: {sync: ...}`; the first is what the others are compared with.
inline const std::vector<std::string> kSyncs{"none", "1", "0.1", "chunk"};

/// One run of the loop with its recorder. @param file  of the recording; replaced.  Returns steps a second. Throws
/// UnavailableError when the run fails.
[[nodiscard]] double stepsPerSecond(const std::string& sync, int steps, const std::filesystem::path& file,
                                    Programs& programs);

}  // namespace baton::bench
