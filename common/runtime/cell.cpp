#include "runtime/cell.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/processes.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace fs = std::filesystem;
namespace {

fs::path cellsFolder() {
  fs::path folder = stateFolder() / "cells";
  makeFolder(folder);
  return folder;
}

std::string lockName(int domain, const std::string& cell, const char* extension) {
  return std::to_string(domain) + "-" + cell + extension;
}

fs::path cellFile(int domain, const std::string& cell) { return cellsFolder() / lockName(domain, cell, ".json"); }

std::optional<RunInfo> readInfo(const fs::path& file) {
  try {
    const nlohmann::json json = nlohmann::json::parse(readFile(file));
    return RunInfo{.cell = json.at("cell"),
                   .run = json.at("run"),
                   .domain = json.at("domain"),
                   .transport = dds::transportCalled(json.at("transport")).value(),
                   .scenario = json.at("scenario"),
                   .folder = json.at("folder"),
                   .recording = json.at("recording"),
                   .supervisor_pid = json.at("supervisor_pid"),
                   .clock = dds::WallClock(json.at("clock_offset_ns").get<std::int64_t>())};
  } catch (const std::exception&) {
    return std::nullopt;  // being written, or from a crash in the middle of writing
  }
}

std::string asText(const RunInfo& info) {
  return toText(nlohmann::ordered_json{{"cell", info.cell},
                                       {"run", info.run},
                                       {"domain", info.domain},
                                       {"transport", dds::toString(info.transport)},
                                       {"scenario", info.scenario},
                                       {"folder", info.folder},
                                       {"recording", info.recording},
                                       {"supervisor_pid", info.supervisor_pid},
                                       {"clock_offset_ns", info.clock.offset()}});
}

/// Locks of an open file, of which one can ask without taking them.
struct flock wholeFile() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

bool lock(int descriptor) {
  struct flock lock = wholeFile();
  return fcntl(descriptor, F_OFD_SETLK, &lock) == 0;
}

/// Whether somebody holds the lock on this file.
bool isHeld(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0 && errno == ENOENT) return false;
  if (descriptor < 0) {
    throw UnavailableError("whether a run is on cannot be seen: cannot open " + file.string() + ": " +
                           std::strerror(errno));
  }
  struct flock lock = wholeFile();
  const bool is_held = fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  close(descriptor);
  return is_held;
}

}  // namespace

CellLock::CellLock(const RunInfo& info) : file_(cellFile(info.domain, info.cell)) {
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) {
    throw UnavailableError("cannot open " + file_.string() + ": " + std::strerror(errno));
  }
  if (!lock(descriptor_)) {
    close(descriptor_);
    const std::optional<RunInfo> other = readInfo(file_);
    throw UnavailableError("cell " + info.cell + " of domain " + std::to_string(info.domain) + " is in use" +
                           (other ? " by run " + other->run + " (" + other->scenario + ", process " +
                                        std::to_string(other->supervisor_pid) + ")"
                                  : "") +
                           ": end that run with `baton down --cell " + info.cell + " --domain " +
                           std::to_string(info.domain) + "`, or choose another cell with --cell");
  }
  const std::string text = asText(info);
  if (ftruncate(descriptor_, 0) != 0 ||
      pwrite(descriptor_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    const int error = errno;
    close(descriptor_);
    throw UnavailableError("cannot write " + file_.string() + ": " + std::strerror(error));
  }
}

CellLock::~CellLock() { close(descriptor_); }

PlantLock::PlantLock(int domain, const std::string& cell, const std::string& run) {
  fs::path file;
  try {
    file = cellsFolder() / lockName(domain, cell, ".plant");
  } catch (const Error&) {
    return;
  }
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor_ < 0) return;
  if (lock(descriptor_)) {
    const std::string text = run + "\n" + std::to_string(getpid()) + "\n";
    if (ftruncate(descriptor_, 0) == 0) std::ignore = pwrite(descriptor_, text.data(), text.size(), 0);
    return;
  }
  const bool is_held = errno == EAGAIN || errno == EACCES;
  std::array<char, 256> said{};  // whose it is; by who took it just now not yet
  const bool is_said = is_held && pread(descriptor_, said.data(), said.size() - 1, 0) > 0;
  close(std::exchange(descriptor_, -1));
  std::istringstream lines(said.data());
  std::string other, pid;
  if (!is_said || !std::getline(lines, other) || !std::getline(lines, pid) || other == run) return;
  throw UnavailableError("cell " + cell + " of domain " + std::to_string(domain) + " has a plant of run " + other +
                         " already, process " + pid + ": end it, or choose another --cell");
}

PlantLock::~PlantLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::optional<RunInfo> activeRun(int domain, const std::string& cell) {
  const fs::path file = cellFile(domain, cell);
  return isHeld(file) ? readInfo(file) : std::nullopt;
}

std::vector<RunInfo> activeRuns() {
  std::vector<RunInfo> runs;
  for (const fs::path& file : listFolder(cellsFolder())) {
    if (!isHeld(file)) continue;
    if (std::optional<RunInfo> info = readInfo(file)) runs.push_back(std::move(*info));
  }
  return runs;
}

std::string keyFile(const RunInfo& info) { return info.folder + "/key"; }

void makeKeyWhenMissing(const RunInfo& info) {
  const std::string file = keyFile(info), draft = file + "." + std::to_string(getpid());
  if (fs::exists(file)) return;
  const std::string text = dds::RunKey::fresh().text() + "\n";
  const int descriptor = open(draft.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  bool is_there = descriptor >= 0 && ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  // Whole or not at all; where two begin at once, both have the first one's.
  is_there = is_there && (link(draft.c_str(), file.c_str()) == 0 || errno == EEXIST);
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  unlink(draft.c_str());
  if (!is_there) throw UnavailableError("cannot write the run's key, " + file + ": " + std::strerror(error));
}

dds::RunKey readKey(const std::string& file) {
  const std::string text = readFile(file);
  const auto key = dds::RunKey::parse(std::string_view(text).substr(0, text.find('\n')));
  if (!key) throw UnavailableError(file + ": expected the key of a run, 64 hexadecimal digits");
  return *key;
}

bool isOfThisUser(const dds::Peer& peer) {
  if (!isFileName(peer.run, "")) return false;  // it comes from outside
  try {
    return isProven(peer, readKey((stateFolder() / "runs" / peer.run / "key").string())) && isRunning(peer);
  } catch (const Error&) {
    return false;
  }
}

dds::ParticipantOptions operatorOf(const RunInfo& info) {
  const std::string file = keyFile(info);
  return {.domain = info.domain,
          .partition = info.cell + "/" + info.run,
          .cell = info.cell,
          .run = info.run,
          .service = kOperatorPrefix + std::to_string(getpid()),
          .role = dds::Role::kOperator,
          .transport = info.transport,
          .key = !info.folder.empty() && fs::exists(file) ? std::optional(readKey(file)) : std::nullopt,
          .clock = info.clock};
}

namespace {
fs::path signpost(const fs::path& run_folder, const std::string& name) { return run_folder / "elsewhere" / name; }
}  // namespace

void sendElsewhere(const RunInfo& info, const fs::path& path) {
  const fs::path file = signpost(info.folder, path.filename().string());
  makeFolder(file.parent_path());
  writeFile(file, path.parent_path().string());
}

fs::path placeOf(const fs::path& key_file, const fs::path& folder, const std::string& name) {
  const fs::path file = signpost(key_file.parent_path(), name);
  const bool is_elsewhere = !key_file.empty() && fs::exists(file);
  return (is_elsewhere ? fs::path(readFile(file)) : folder) / name;
}

std::string keptScenario(const RunInfo& info) { return info.folder + "/scenario.yaml"; }
std::string keptRobot(const RunInfo& info) { return info.folder + "/robot.yaml"; }

void keepExperiment(const RunInfo& info, const Scenario& scenario) {
  writeFile(keptScenario(info), scenario.text);
  writeFile(keptRobot(info), scenario.robot_text);
}

fs::path runFolder(const std::string& run) {
  fs::path folder = stateFolder() / "runs" / run;
  makePrivateFolder(folder);
  return folder;
}

fs::path replayFolder(int domain, const std::string& cell, const std::string& run) {
  return stateFolder() / "replays" / std::to_string(domain) / cell / run;
}

std::set<std::string> replaysOfThisUser(int domain, const std::string& cell) {
  std::set<std::string> names;
  for (const fs::path& path : listFolder(replayFolder(domain, cell, ""))) {
    const int folder = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) continue;
    const bool is_held = flock(folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (is_held) names.insert(path.filename().string());
    close(folder);
  }
  return names;
}

void makePrivateFolder(const fs::path& folder) {
  makeFolder(folder);
  std::error_code error;
  fs::permissions(folder, fs::perms::owner_all, error);
  if (error) throw UnavailableError("cannot make " + folder.string() + " private: " + error.message());
}

}  // namespace baton
