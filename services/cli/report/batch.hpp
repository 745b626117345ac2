/// Many scenarios, run to their ends as the distributed system they describe, a few at a time, each in a cell of its
/// own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dds/types.hpp"

namespace baton {

struct BatchOptions {
  std::filesystem::path folder;  // of the recordings and of what their runs said
  int domain = 0;
  dds::Transport transport = dds::Transport::kUdp;
  int jobs = 2;        // runs at the same time
  bool fresh = false;  // run also what is there already
};

struct BatchRun {
  std::string scenario;  // name: the file's stem
  std::filesystem::path file;
  std::filesystem::path recording;
  bool was_reused = false;
  std::string failure;  // empty when the recording is there and complete
};

/// Runs what has no recording yet, or one of another text of the scenario or the robot, or by another build; what was
/// interrupted is not there and so runs again next time. Shows progress with the time left. Ctrl-C ends the runs in
/// order and throws Error with kInterrupted.
[[nodiscard]] std::vector<BatchRun> runBatch(const std::vector<std::filesystem::path>& scenarios,
                                             const BatchOptions& options);

}  // namespace baton
