#include "runtime/recording_files.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/error.hpp"
#include "mcap/lookup.hpp"
#include "mcap/readable_metadata.hpp"
#include "runtime/recorded_extras.hpp"
#include "runtime/recording_parts.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

/// What a file says of itself.
struct Said {
  fs::path path;
  mcap::StringMap run;                   // of which run; empty: not recorded by Baton
  std::string profile;                   // of the file's header
  std::string first;                     // of a part: the name that the first part had
  std::optional<unsigned> index;         // of a part
  std::string next{};                    // of a part: the file in which it goes on; empty in the last
  std::optional<unsigned> first_kept{};  // of the last part, when it was closed: the first that was not dropped
  std::uint64_t begin_ns = 0;            // log times
  std::uint64_t end_ns = 0;
  bool has_messages = false;

  [[nodiscard]] std::string runId() const { return mcap::valueOf(run, "run"); }
};

std::optional<unsigned> indexOf(const mcap::StringMap& part) {
  const std::string text = mcap::valueOf(part, "index");
  unsigned index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(index) : std::nullopt;
}

Said askFile(const fs::path& path) {
  // Damage is for whoever reads the messages.
  const mcap::Reader reader(path, {.trusts_summary = true, .on_damage = [](const mcap::Damage&) {}});
  Said said{.path = path, .run = {}, .profile = reader.info().header.profile, .first = {}, .index = {}};
  bool is_copy = false;
  for (const mcap::Metadata& one : mcap::readableMetadata(reader)) {
    if (one.name == "baton.run") said.run = one.values;
    if (one.name == "baton.cut") is_copy = true;
    if (one.name == "baton.part") {
      said.first = mcap::valueOf(one.values, "first");
      said.index = indexOf(one.values);
    }
    if (one.name == "baton.part_end") said.next = mcap::valueOf(one.values, "next");
  }
  if (said.index && hasCertificate(reader)) said.first_kept = firstPartKept(reader);
  if (is_copy) said.index.reset();  // a piece of a part is none
  said.begin_ns = reader.statistics().start_time_ns;
  said.end_ns = reader.statistics().end_time_ns;
  said.has_messages = reader.statistics().message_count > 0;
  return said;
}

/// Recordings in a folder, those of its subfolders not.
std::vector<fs::path> recordingsIn(const fs::path& folder, const char* ending = ".mcap") {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder)) {
    if (entry.path().extension() == ending && entry.is_regular_file()) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<fs::path> expandFolders(const std::vector<std::string>& given) {
  std::vector<fs::path> paths;
  for (const std::string& one : given) {
    std::error_code no_folder;
    if (!fs::is_directory(one, no_folder)) {
      paths.emplace_back(one);
      continue;
    }
    std::vector<fs::path> inside = recordingsIn(one);
    for (const char* foreign : {".db3", ".bag", ".zstd", ".zst", ".gz"}) {  // refused with what to do about it
      if (inside.empty()) inside = recordingsIn(one, foreign);
    }
    if (inside.empty()) {
      throw UsageError(one +
                       ": expected a folder with recordings (*.mcap), found none in it; those in folders in it are "
                       "not looked for: give their folder, or a file");
    }
    paths.insert(paths.end(), inside.begin(), inside.end());
  }
  return paths;
}

/// Whether it is a part of the recording that began in `first`, by its name.
bool isCalledAsPart(const fs::path& file, const std::string& first) {
  const fs::path recording = file.parent_path() / first;
  return file == recording || std::ranges::count(furtherPartsOf(recording), file) > 0;
}

/// Adds the parts that lie next to one, whatever they are called. A file that cannot be read says nothing but its name.
void addSiblings(std::vector<Said>& files, std::vector<std::string>& unreadable) {
  std::set<fs::path> known;
  for (const Said& one : files) known.insert(fs::absolute(one.path).lexically_normal());
  for (std::size_t i = 0, given = files.size(); i < given; ++i) {
    if (!files[i].index) continue;
    for (const fs::path& path : recordingsIn(files[i].path.parent_path())) {
      if (known.contains(fs::absolute(path).lexically_normal())) continue;
      try {
        Said other = askFile(path);
        if (!other.index || other.runId() != files[i].runId() || other.first != files[i].first) continue;
        known.insert(fs::absolute(path).lexically_normal());
        files.push_back(std::move(other));
      } catch (const Error& error) {
        if (!isCalledAsPart(path, files[i].first)) continue;  // of something else
        known.insert(fs::absolute(path).lexically_normal());
        unreadable.push_back("a part cannot be read and is left out: " + std::string(error.what()));
      }
    }
  }
}

std::vector<Said> askFiles(const std::vector<fs::path>& paths, bool with_parts, std::vector<std::string>& unreadable) {
  std::vector<Said> files;
  files.reserve(paths.size());
  for (const fs::path& path : paths) files.push_back(askFile(path));
  if (with_parts) addSiblings(files, unreadable);
  return files;
}

/// What keeps two files from being of one recording; empty when nothing does.
std::string differenceOf(const Said& a, const Said& b) {
  if (a.run.empty() != b.run.empty()) {
    return (a.run.empty() ? a : b).path.string() + " was not recorded by Baton, the other was";
  }
  std::string text;
  for (const char* key : {"run", "cell", "scenario", "robot", "host"}) {
    const std::string one = mcap::valueOf(a.run, key), other = mcap::valueOf(b.run, key);
    if (one == other) continue;
    text += fmt::format("{}{} {} and {}", text.empty() ? "" : ", ", key, one, other);
  }
  if (a.runId() == b.runId() && !a.run.empty()) return "";
  if (a.run.empty() && a.profile != b.profile) {
    return fmt::format("profile '{}' and '{}'", a.profile, b.profile);
  }
  return text;
}

void expectOneRun(const std::vector<Said>& files) {
  for (const Said& one : files) {
    const std::string difference = differenceOf(files.front(), one);
    if (difference.empty()) continue;
    throw UsageError(
        fmt::format("expected files of one recording, found {} and {}, of different runs: {}; `baton bag "
                    "merge` makes one file of recordings of several runs",
                    files.front().path.string(), one.path.string(), difference));
  }
}

bool areParts(const std::vector<Said>& files) {
  return std::ranges::all_of(files, [&](const Said& one) { return one.index && one.first == files.front().first; });
}

/// Throws for two that have the same of a run. Overlaps of other people's recordings are theirs.
void expectNothingTwice(const std::vector<Said>& files, bool are_parts) {
  for (std::size_t i = 1; i < files.size(); ++i) {
    const Said &a = files[i - 1], &b = files[i];
    std::error_code missing;
    const bool is_same = fs::equivalent(a.path, b.path, missing);
    if (is_same || (are_parts && a.index == b.index)) {
      throw UsageError(fmt::format("expected each part once, found {} and {}, {}", a.path.string(), b.path.string(),
                                   is_same ? "the same file" : fmt::format("both part {}", *a.index)));
    }
    const bool overlap = !are_parts && !a.run.empty() && a.has_messages && b.has_messages && b.begin_ns < a.end_ns;
    if (overlap) {
      throw UsageError(fmt::format(
          "expected recordings of one stretch of the run after another, found {} and {}, which "
          "overlap by {:.3f} s",
          a.path.string(), b.path.string(), static_cast<double>(std::min(a.end_ns, b.end_ns) - b.begin_ns) * 1e-9));
    }
  }
}

/// "part 2 is missing", of those from the first to before the end.
std::string missingText(unsigned first, unsigned end) {
  return first + 1 == end ? fmt::format("part {} is missing", first)
                          : fmt::format("parts {} to {} are missing", first, end - 1);
}

/// @param parts  in their order, at least one.
std::vector<std::string> holesIn(const std::vector<Said>& parts, bool with_ends) {
  std::vector<std::string> holes;
  // A recorder that was killed has not said which parts of a ring it has dropped itself.
  const unsigned first = *parts.front().index, expected = parts.back().first_kept.value_or(first);
  if (with_ends && first > expected) {
    holes.push_back(fmt::format("{} before {}", missingText(expected, first), parts.front().path.string()));
  }
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const unsigned after = *parts[i - 1].index, before = *parts[i].index;
    if (before <= after + 1) continue;
    holes.push_back(fmt::format("{} between {} and {}", missingText(after + 1, before), parts[i - 1].path.string(),
                                parts[i].path.string()));
  }
  const Said& last = parts.back();
  if (with_ends && !last.next.empty()) {
    holes.push_back(fmt::format("{}, in which it goes on, is missing after {}", last.next, last.path.string()));
  }
  return holes;
}

}  // namespace

CLI::Option* addRecording(CLI::App& command, RecordingWish& wish, const char* name, const char* text) {
  addParts(command, wish.with_parts);
  return command.add_option(name, wish.given, text)->required();
}

void addParts(CLI::App& command, bool& with_parts) {
  command.add_flag("--parts", with_parts,
                   "of a recording that was split also the other parts, which lie in the same folder");
}

std::vector<std::string> filesOf(const RecordingWish& wish, std::vector<std::string>* unreadable) {
  std::vector<fs::path> paths = expandFolders(wish.given);
  if (wish.with_parts) {
    std::vector<std::string> ignored;
    std::vector<Said> files = askFiles(paths, true, unreadable == nullptr ? ignored : *unreadable);
    paths.clear();
    for (const Said& one : files) paths.push_back(one.path);
  }
  return {paths.begin(), paths.end()};
}

FoundRecording findRecording(const RecordingWish& wish) {
  const std::vector<fs::path> paths = expandFolders(wish.given);
  std::error_code none;
  const bool wants_all = wish.with_parts || std::ranges::any_of(wish.given, [&](const std::string& one) {
                           return fs::is_directory(one, none);
                         });
  if (paths.size() == 1 && !wants_all) return {mcap::FileList(paths), {}};
  FoundRecording found;
  std::vector<Said> files = askFiles(paths, wish.with_parts, found.missing);
  expectOneRun(files);
  const bool are_parts = areParts(files);
  std::ranges::stable_sort(files, [&](const Said& a, const Said& b) {
    return are_parts ? a.index < b.index : std::pair(a.begin_ns, a.end_ns) < std::pair(b.begin_ns, b.end_ns);
  });
  expectNothingTwice(files, are_parts);
  std::vector<fs::path> ordered;
  ordered.reserve(files.size());
  for (const Said& one : files) ordered.push_back(one.path);
  found.files = mcap::FileList(std::move(ordered));
  if (are_parts) std::ranges::move(holesIn(files, wants_all), std::back_inserter(found.missing));
  return found;
}

std::vector<std::string> missingParts(const std::vector<std::string>& files) {
  std::map<std::pair<std::string, std::string>, std::vector<Said>> recordings;
  for (const std::string& file : files) {
    Said said = askFile(file);
    if (said.index) recordings[{said.runId(), said.first}].push_back(std::move(said));
  }
  std::vector<std::string> holes;
  for (auto& [recording, parts] : recordings) {
    std::ranges::sort(parts, {}, &Said::index);
    std::ranges::move(holesIn(parts, true), std::back_inserter(holes));
  }
  return holes;
}

mcap::FileList findRecording(const RecordingWish& wish, ExitCode& exit_code) {
  FoundRecording found = findRecording(wish);
  for (const std::string& hole : found.missing) sayWarning(hole);
  if (!found.missing.empty()) exit_code = ExitCode::kFailed;
  return std::move(found.files);
}

void warnIfIncomplete(const std::string& file, const mcap::FileInfo& info, ExitCode& exit_code) {
  if (info.is_complete) return;
  sayWarning(file + ": " + mcap::incompletenessOf(info));
  exit_code = ExitCode::kFailed;
}

}  // namespace baton
