/// Who uses a cell on this machine. A cell is one robot with its parts; the supervisor of its run holds a lock on it,
/// which the kernel lets go when the process ends, however it ends. Beside the lock stands what others need to reach
/// the run.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dds/participant.hpp"
#include "runtime/scenario.hpp"

namespace baton {

struct RunInfo {
  std::string cell;
  std::string run;
  int domain = 0;
  dds::Transport transport = dds::Transport::kUdp;
  std::string scenario;   // its file
  std::string folder;     // logs, result
  std::string recording;  // empty: none
  int supervisor_pid = 0;
  dds::WallClock clock{};
};

/// Held by the supervisor for as long as its run lives.
class CellLock {
 public:
  /// Takes the cell and writes `info` beside the lock. Throws UnavailableError, naming the run that holds it and how to
  /// end it, when the cell is taken.
  explicit CellLock(const RunInfo& info);
  ~CellLock();
  CellLock(const CellLock&) = delete;
  CellLock& operator=(const CellLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// Held by the plant of a run for as long as its process lives, so that a plant whose supervisor has gone keeps its
/// cell. Discovery alone tells of it later, of a plant elsewhere, of a second one of the same run, and where there is
/// no folder for locks.
class PlantLock {
 public:
  /// Throws UnavailableError, naming run and process, when a plant of another run has the cell.
  PlantLock(int domain, const std::string& cell, const std::string& run);
  ~PlantLock();
  PlantLock(const PlantLock&) = delete;
  PlantLock& operator=(const PlantLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// The run that holds a cell now, if any.
[[nodiscard]] std::optional<RunInfo> activeRun(int domain, const std::string& cell);

/// All runs alive on this machine.
[[nodiscard]] std::vector<RunInfo> activeRuns();

/// The folder of a run, its owner's alone; created when missing.
[[nodiscard]] std::filesystem::path runFolder(const std::string& run);
/// Where a replay has its key while it lives. Nothing is created.
[[nodiscard]] std::filesystem::path replayFolder(int domain, const std::string& cell, const std::string& run);
/// The names of those that live: each holds a lock (flock) on its folder.
[[nodiscard]] std::set<std::string> replaysOfThisUser(int domain, const std::string& cell);
/// Makes it when it is missing, for its owner alone.
void makePrivateFolder(const std::filesystem::path& folder);

/// The key of a run, a file in its folder that only its owner can read: whoever can may operate the run. Throws
/// UnavailableError when it cannot be written or read.
[[nodiscard]] std::string keyFile(const RunInfo& info);
void makeKeyWhenMissing(const RunInfo& info);
[[nodiscard]] dds::RunKey readKey(const std::string& file);
/// Whether a process that runs has the key of the run it calls its own, by that run's folder: a run of this user's,
/// then.
[[nodiscard]] bool isOfThisUser(const dds::Peer& peer);
/// Of a process of ours that watches or operates a run; without a key where the run has none.
[[nodiscard]] dds::ParticipantOptions operatorOf(const RunInfo& info);

/// Where a recording that is asked for goes. Over the wire comes only a name; that it leads into another folder than
/// that of the run's recording is said in the run's own folder, where only the run's owner writes.
void sendElsewhere(const RunInfo& info, const std::filesystem::path& path);
/// @param folder  of the run's recording.
[[nodiscard]] std::filesystem::path placeOf(const std::filesystem::path& key_file, const std::filesystem::path& folder,
                                            const std::string& name);

/// The run keeps the experiment as it was, whatever becomes of the files: its services and the commands that speak to
/// it read the copies in its folder. Throws UnavailableError when they cannot be written.
void keepExperiment(const RunInfo& info, const Scenario& scenario);
[[nodiscard]] std::string keptScenario(const RunInfo& info);
[[nodiscard]] std::string keptRobot(const RunInfo& info);

}  // namespace baton
