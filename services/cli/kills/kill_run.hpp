/// One run in which a process is killed at a step, by its id, as it comes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "kills/kill_case.hpp"
#include "run_session.hpp"

namespace baton {

struct KilledRun {
  std::string service;     // that was killed; empty: none was
  std::uint64_t step = 0;  // the latest whose state had come
  ExitCode exit_code = ExitCode::kOk;
  nlohmann::ordered_json result;  // as in result.json
};

/// Follows a run until its supervisor ends. kInterrupted when a signal asked for that, whatever became of the run.
[[nodiscard]] ExitCode followToItsEnd(RunSession& session, const std::function<void(const RunProgress&)>& progress);

/// Runs `scenario` in `folder`, recorded to `request.out`, with this kill or undisturbed.
[[nodiscard]] KilledRun killRun(const Scenario& scenario, const std::optional<Kill>& kill,
                                const std::filesystem::path& folder, RunRequest request);

}  // namespace baton
