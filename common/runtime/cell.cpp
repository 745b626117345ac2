#include "runtime/cell.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "base/error.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace fs = std::filesystem;
namespace {

fs::path cellsFolder() {
  fs::path folder = stateFolder() / "cells";
  fs::create_directories(folder);
  return folder;
}

fs::path cellFile(int domain, const std::string& cell) {
  return cellsFolder() / (std::to_string(domain) + "-" + cell + ".json");
}

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
                   .supervisor_pid = json.at("supervisor_pid")};
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
                                       {"supervisor_pid", info.supervisor_pid}});
}

/// Locks of an open file, of which one can ask without taking them.
struct flock wholeFile() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

/// Whether somebody holds the lock on this file.
bool isHeld(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return false;
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
  struct flock lock = wholeFile();
  if (fcntl(descriptor_, F_OFD_SETLK, &lock) != 0) {
    close(descriptor_);
    const std::optional<RunInfo> other = readInfo(file_);
    throw UnavailableError("cell " + info.cell + " of domain " + std::to_string(info.domain) + " is in use" +
                           (other ? " by run " + other->run + " (" + other->scenario + ", process " +
                                        std::to_string(other->supervisor_pid) + ")"
                                  : "") +
                           ": end that run with `baton down --cell " + info.cell +
                           "`, or choose another cell with --cell");
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

std::optional<RunInfo> activeRun(int domain, const std::string& cell) {
  const fs::path file = cellFile(domain, cell);
  return isHeld(file) ? readInfo(file) : std::nullopt;
}

std::vector<RunInfo> activeRuns() {
  std::vector<RunInfo> runs;
  for (const auto& entry : fs::directory_iterator(cellsFolder())) {
    if (!isHeld(entry.path())) continue;
    if (std::optional<RunInfo> info = readInfo(entry.path())) runs.push_back(std::move(*info));
  }
  return runs;
}

std::string keptScenario(const RunInfo& info) { return info.folder + "/scenario.yaml"; }
std::string keptRobot(const RunInfo& info) { return info.folder + "/robot.yaml"; }

void keepExperiment(const RunInfo& info, const Scenario& scenario) {
  for (const auto& [file, text] :
       {std::pair{keptScenario(info), scenario.text}, std::pair{keptRobot(info), scenario.robot_text}}) {
    const std::string draft = file + ".new";  // whoever reads it meanwhile sees the old one whole
    std::ofstream stream(draft, std::ios::binary);
    stream << text;
    stream.close();
    std::error_code error;
    if (stream) fs::rename(draft, file, error);
    if (!stream || error)
      throw UnavailableError("cannot write " + file + ": expected space and the right to write there");
  }
}

fs::path runFolder(const std::string& run) {
  fs::path folder = stateFolder() / "runs" / run;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw UnavailableError("cannot make " + folder.string() + ": " + error.message());
  return folder;
}

}  // namespace baton
