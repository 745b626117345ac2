/// A run started from the command line: launches the supervisor, follows it, reads its result.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dds/types.hpp"
#include "msg/record.h"
#include "msg/sim.h"
#include "runtime/cell.hpp"
#include "runtime/scheduling.hpp"

namespace baton {

struct RunRequest {
  std::string scenario;  // path or bare name
  std::string cell = "lab";
  int domain = 0;
  dds::Transport transport = dds::Transport::kUdp;
  std::string out;  // recording; empty: in the run's folder
  bool no_recording = false;
  bool record_later = false;                   // the recorder waits for a request
  bool overwrite = false;                      // replace `out`
  std::vector<std::filesystem::path> reads{};  // besides scenario and robot: `out` is none of them
  int restarts = 0;
  std::string checkpoint;  // to go on from; empty: the scenario's start
  Scheduling scheduling;
  bool paused = false;   // waits for a request before its first step
  bool is_open = false;  // takes requests from anybody
};

/// The latest words of a run, as far as there are some.
struct RunProgress {
  std::optional<msg::SimStatus> sim;
  std::optional<msg::RecorderStatus> recorder;
};

/// A supervisor's process. Attached, it ends with this one; detached, it lives on in the background.
class RunSession {
 public:
  /// Checks what can be checked before anything is started and launches the supervisor. Throws UsageError and
  /// UnavailableError.
  RunSession(const RunRequest& request, bool attached);
  ~RunSession();
  RunSession(const RunSession&) = delete;
  RunSession& operator=(const RunSession&) = delete;

  /// Follows the run until `until` says so or the supervisor ends. A signal that asks for the end is passed on to the
  /// supervisor, whose orderly end is waited for. `progress` is called several times a second. Returns the supervisor's
  /// exit code, or nothing when `until` ended it.
  std::optional<ExitCode> follow(const std::function<void(const RunProgress&)>& progress,
                                 const std::function<bool(const msg::SimStatus&)>& until);

  /// result.json, once the supervisor has ended. Throws UnavailableError with the end of its log when there is none.
  [[nodiscard]] nlohmann::ordered_json result() const;
  /// A signal asked for the end. The run may have ended for another reason, and its exit code says that one.
  [[nodiscard]] bool wasInterrupted() const;
  [[nodiscard]] const RunInfo& info() const { return info_; }
  [[nodiscard]] std::string logFile() const { return info_.folder + "/supervisor.log"; }

 private:
  class SignalCounter;
  std::unique_ptr<SignalCounter> signals_;  // from before the launch: no Ctrl-C is missed
  RunInfo info_;
};

/// result.json of a run folder.
[[nodiscard]] nlohmann::ordered_json readResult(const std::string& folder);

/// What a person wants to know of a run that has ended, from its result.json. One without a folder has no logs.
void printResult(const nlohmann::ordered_json& result);

}  // namespace baton
