#include "runtime/paths.hpp"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <random>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mcap/bytes.hpp"
#include "mcap/error.hpp"
#include "mcap/file.hpp"

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
  std::string reason;
  for (const fs::path& folder : {own, own.parent_path() / "libexec/baton"}) {
    const fs::path path = folder / name;
    if (access(path.c_str(), X_OK) == 0) return path;
    if (errno != ENOENT) reason = path.string() + ": " + std::strerror(errno);
  }
  if (!reason.empty()) throw UnavailableError("the program cannot be run: " + reason);
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
constexpr const char* kNothing = "nothing";
}

std::string whyNoFile(const fs::path& path) {
  std::error_code error;
  switch (fs::status(path, error).type()) {
    case fs::file_type::regular: return "";
    case fs::file_type::directory: return "a folder";
    case fs::file_type::not_found: return kNothing;
    case fs::file_type::none: return "one that cannot be looked at: " + error.message();
    default: return "a device, a pipe or a socket";
  }
}

namespace {

/// @param kind  "scenario": what is meant, and with an s the folder of those that come with Baton.
fs::path findNamed(const std::string& kind, const std::string& name) {
  const std::string found = whyNoFile(name);
  if (found.empty()) return fs::absolute(name);
  const fs::path folder = dataFolder() / (kind + "s");
  std::error_code is_none;  // also a name that no file can have
  if (fs::path known = folder / (name + ".yaml"); fs::is_regular_file(known, is_none)) return known;
  if (found != kNothing) {
    throw UsageError(kind + " " + escaped(name.substr(0, kMaxShown)) + ": expected a file, found " + found);
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
  std::error_code error;
  if (!fs::is_directory(path.parent_path(), error)) {
    const std::string found = whyNoFile(path.parent_path());
    throw UsageError("--out " + escaped(out.substr(0, kMaxShown)) + ": expected a file in an existing folder, and " +
                     escaped(path.parent_path().string().substr(0, kMaxShown)) + " is " +
                     (found == kNothing ? "none"
                      : found.empty()   ? "a file"
                                        : found));
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
  int error = 0;
  std::string text = readFile(path, std::numeric_limits<std::size_t>::max(), error);
  if (error != 0) throw UnavailableError("cannot read " + path.string() + ": " + std::strerror(error));
  return text;
}

std::string readFile(const fs::path& path, std::size_t most_bytes, int& error) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), &std::fclose);
  error = file ? 0 : errno;
  std::string text;
  std::array<char, 1U << 14> buffer{};
  while (error == 0 && text.size() < most_bytes) {
    const std::size_t got = std::fread(buffer.data(), 1, std::min(buffer.size(), most_bytes - text.size()), file.get());
    text.append(buffer.data(), got);
    if (std::ferror(file.get()) != 0) error = errno;
    if (got == 0) break;
  }
  return error == 0 ? text : "";
}

void writeFile(const fs::path& path, std::string_view text) {
  try {
    mcap::OutputFile file(path, mcap::OutputFile::IfExists::kReplace);
    file.write(mcap::asBytes(text));
    file.close();
  } catch (const mcap::WriteError& error) {
    throw UnavailableError(std::string("cannot write ") + error.what());
  }
}

std::vector<fs::path> listFolder(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    paths.push_back(entry->path());
  if (error && error != std::errc::no_such_file_or_directory) {
    throw UnavailableError("cannot read the folder " + folder.string() + ": " + error.message());
  }
  return paths;
}

}  // namespace baton
