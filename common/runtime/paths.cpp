#include "runtime/paths.hpp"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <chrono>
#include <climits>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>

#include "base/error.hpp"
#include "base/text.hpp"

namespace baton {
namespace fs = std::filesystem;
namespace {
constexpr std::size_t kMaxShown = 200;  // characters of a path that is none
}

fs::path stateFolder() {
  const auto variable = [](const char* name) -> std::string {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
  };
  fs::path folder;
  if (const std::string home = variable("BATON_HOME"); !home.empty()) {
    folder = home;
  } else if (const std::string state = variable("XDG_STATE_HOME"); !state.empty()) {
    folder = fs::path(state) / "baton";
  } else if (const std::string user = variable("HOME"); !user.empty()) {
    folder = fs::path(user) / ".local/state/baton";
  } else {
    throw UnavailableError("no folder for runs: expected BATON_HOME, XDG_STATE_HOME or HOME to be set; set BATON_HOME");
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw UnavailableError("cannot make the folder of runs " + folder.string() + ": " + error.message() +
                           "; set BATON_HOME to a folder you may write to");
  }
  return fs::absolute(folder);
}

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw UnavailableError("cannot make the folder " + folder.string() + ": " + error.message());
}

fs::path programFolder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

bool isInstalled() {
  const fs::path own = programFolder();
  return !(fs::exists(own / "baton") && fs::exists(own / "baton-supervisor"));
}

fs::path siblingProgram(const std::string& name) {
  const fs::path own = programFolder();
  for (const fs::path& folder : {own, own.parent_path() / "libexec/baton"}) {
    if (fs::path path = folder / name; access(path.c_str(), X_OK) == 0) return path;
  }
  throw UnavailableError("the program " + (own / name).string() + " is missing: build or install Baton again");
}

fs::path dataFolder() {
  const fs::path above = programFolder().parent_path();
  for (const fs::path& prefix : {above, above.parent_path()}) {
    if (fs::path folder = prefix / "share/baton"; fs::exists(folder / "scenarios")) return folder;
  }
  throw UnavailableError("expected Baton's scenarios and robots in " + (above / "share/baton").string() +
                         ", found nothing: build or install Baton again, or give whole paths");
}

namespace {
/// @param kind  "scenario": what is meant, and with an s the folder of those that come with Baton.
fs::path findNamed(const std::string& kind, const std::string& name) {
  std::error_code is_none;  // also a name that no file can have
  if (fs::is_regular_file(name, is_none)) return fs::absolute(name);
  const fs::path folder = dataFolder() / (kind + "s");
  if (fs::path known = folder / (name + ".yaml"); fs::is_regular_file(known, is_none)) return known;
  if (fs::is_directory(name, is_none)) {
    throw UsageError(kind + " " + escaped(name) + ": expected a file, found a folder");
  }
  std::string names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") names += (names.empty() ? "" : ", ") + entry.path().stem().string();
  }
  throw UsageError(kind + " " + escaped(name.substr(0, kMaxShown)) + ": expected a file or one of " + names +
                   ", found neither");
}
}  // namespace

fs::path findScenario(const std::string& name) { return findNamed("scenario", name); }
fs::path findRobot(const std::string& name) { return findNamed("robot", name); }

std::filesystem::path outputPath(const std::string& out) {
  std::filesystem::path path = std::filesystem::absolute(out);
  std::error_code is_none;  // also a name that no folder can have
  if (!fs::is_directory(path.parent_path(), is_none)) {
    throw UsageError("--out " + escaped(out.substr(0, kMaxShown)) + ": expected a file in an existing folder, and " +
                     escaped(path.parent_path().string().substr(0, kMaxShown)) + " is none");
  }
  if (path.filename().string().size() > NAME_MAX) {
    throw UsageError("--out " + escaped(out.substr(0, kMaxShown)) + ": expected a name of at most " +
                     std::to_string(NAME_MAX) + " characters");
  }
  return path;
}

std::string newRunId() {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y%m%d-%H%M%S}-{:04x}", fmt::gmtime(std::chrono::system_clock::to_time_t(now)),
                     std::random_device{}() & 0xFFFFU);
}

std::string readFile(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) throw UnavailableError("cannot read " + path.string());
  return text.str();
}

}  // namespace baton
