/// A recorded run, done again from its file alone and compared byte by byte.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "bag/run_hash.hpp"
#include "made_with.hpp"
#include "recorded_run.hpp"
#include "run_session.hpp"

namespace baton {

struct Rerun {
  Comparison comparison;                       // of the recording and its repetition
  std::uint64_t steps = 0;                     // of the recording
  std::optional<std::uint64_t> first_missing;  // step of the recording that the repetition has not
  bool was_interrupted = false;                // the repetition, by Ctrl-C or a signal
  std::size_t decisions = 0;                   // that were repeated
  std::uint64_t hash = 0;                      // of the recording
  nlohmann::ordered_json result;               // of the repetition, as in its result.json
  std::filesystem::path recording;             // the repetition
  std::vector<MadeWithDifference> made_with;   // what differs of what recorded the two

  [[nodiscard]] bool isIdentical() const { return !comparison.parting && !first_missing; }
  /// The verdict as a sentence. Where the bytes differ, what the two runs were made with comes first.
  [[nodiscard]] std::string text() const;
};

/// Runs the whole distributed system in `folder`, which is there. `run` says in which cell and to which file; `follow`
/// waits for its end. Throws UsageError for what cannot be repeated, and what a run throws.
[[nodiscard]] Rerun rerun(const mcap::FileList& recording, const std::filesystem::path& folder, RunRequest run,
                          const std::function<ExitCode(RunSession&)>& follow);

}  // namespace baton
