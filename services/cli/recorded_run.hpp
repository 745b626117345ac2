/// A recorded run as an experiment that can be done again: what its file says beside its messages, and the decisions
/// that were made while it ran. `rerun` repeats it from them, `branch` the steps before its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mcap/joined_reader.hpp"
#include "msg/decision.h"
#include "runtime/scenario.hpp"

namespace baton {

/// Of a run that was reset, its last take.
struct RecordedRun {
  mcap::FileList file;
  std::string scenario_text;
  std::string robot_text;
  std::optional<std::string> checkpoint;  // the bytes of the file that a branch began with
  Scenario scenario;
  std::uint64_t begin_ns = 0;  // log time of the take's begin
  // The first of the checkpoints that are of this scenario: before a controller is given another law they are not.
  std::uint64_t checkpoints_from_ns = 0;
  std::uint64_t first_step = 0;
  std::uint64_t last_step = 0;           // of which there is a state
  std::vector<msg::Decision> decisions;  // of each writer in their order
};

/// Throws UsageError when the file is not the recording of a run, and what reading a recording throws.
[[nodiscard]] RecordedRun readRecordedRun(const mcap::FileList& file);

/// The handovers of the scenario and those that operators asked for, by step.
[[nodiscard]] std::vector<PlannedSwap> swapsOf(const RecordedRun& run);

/// Who failed when, and came back when.
[[nodiscard]] std::vector<PlannedFailure> failuresOf(const RecordedRun& run);
/// The parameters that operators asked for, and their end with the process that had them.
[[nodiscard]] std::vector<PlannedChange> askedChangesOf(const RecordedRun& run);

/// A scenario that repeats the run by itself up to `end_step`, decision by decision, as fast as possible, and where
/// nobody is late. The robot is the file `robot.yaml` beside it.
[[nodiscard]] std::string repeatingScenario(const RecordedRun& run, std::uint64_t end_step);

/// A step as a time of the run, exactly.
[[nodiscard]] std::string secondsText(std::uint64_t step, const Scenario& scenario);
/// As a scenario's `swaps` has them.
[[nodiscard]] std::string swapsText(const std::vector<PlannedSwap>& swaps, const Scenario& scenario);

}  // namespace baton
