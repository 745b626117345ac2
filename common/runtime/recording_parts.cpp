#include "runtime/recording_parts.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <system_error>

#include "base/error.hpp"
#include "mcap/lookup.hpp"
#include "mcap/readable_metadata.hpp"
#include "mcap/reader.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace fs = std::filesystem;
namespace {

/// Why a file is not taken for a part of an earlier recording of that name; empty when it says itself that it is one.
std::string whyNoPart(const fs::path& file, const fs::path& recording) {
  try {
    const mcap::Reader reader(file, {.trusts_summary = true, .on_damage = [](const mcap::Damage&) {}});
    const bool is_part = std::ranges::any_of(mcap::readableMetadata(reader), [&](const mcap::Metadata& one) {
      return one.name == "baton.part" && mcap::valueOf(one.values, "first") == recording.filename().string();
    });
    return is_part ? "" : "is none";
  } catch (const UnavailableError& error) {
    return std::string("cannot be asked: ") + error.what();
  } catch (const Error&) {
    return "is none";
  }
}

}  // namespace

fs::path partOf(const fs::path& recording, unsigned index) {
  if (index == 0) return recording;
  std::string number = std::to_string(index);
  constexpr std::size_t kDigits = 4;
  if (number.size() < kDigits) number.insert(0, kDigits - number.size(), '0');
  return recording.parent_path() / (recording.stem().string() + "_" + number + recording.extension().string());
}

std::vector<fs::path> furtherPartsOf(const fs::path& recording) {
  std::map<unsigned long, fs::path> parts;
  const std::string begin = recording.stem().string() + "_";
  const fs::path folder = recording.has_parent_path() ? recording.parent_path() : ".";
  std::error_code no_folder;
  for (const auto& entry : fs::directory_iterator(folder, no_folder)) {
    const std::string stem = entry.path().stem().string();
    if (!stem.starts_with(begin) || entry.path().extension() != recording.extension()) continue;
    const std::string number = stem.substr(begin.size());
    constexpr std::size_t kMostDigits = 9;
    if (number.empty() || number.size() > kMostDigits ||
        !std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; }))
      continue;
    const unsigned long index = std::stoul(number);
    if (partOf(recording, static_cast<unsigned>(index)).filename() == entry.path().filename()) {
      parts[index] = partOf(recording, static_cast<unsigned>(index));
    }
  }
  std::vector<fs::path> result;
  result.reserve(parts.size());
  for (const auto& [index, part] : parts) result.push_back(part);
  return result;
}

fs::path claimRecording(const std::string& option, const std::string& out, bool is_split, bool overwrite,
                        const std::vector<fs::path>& reads) {
  fs::path path = outputPath(out);
  if (fs::exists(path) && !fs::is_regular_file(path)) {
    throw UsageError(option + " " + out + ": expected a file, and it is a folder or a device");
  }
  std::vector<fs::path> there;
  if (is_split) there = furtherPartsOf(path);
  for (const fs::path& file : there) {
    const std::string why = whyNoPart(file, path);
    if (why.empty()) continue;
    throw UsageError(option + " " + out + ": a part of it would be called " + file.string() + ", which is there and " +
                     why + ": choose another name");
  }
  if (fs::exists(path)) there.insert(there.begin(), path);
  for (const fs::path& file : there) {
    std::error_code none;  // not there: not the same
    if (std::ranges::none_of(reads, [&](const fs::path& read) { return fs::equivalent(file, read, none); })) continue;
    throw UsageError(option + " " + out + ": " + file.string() + " is what is read here: choose another name");
  }
  if (!there.empty() && !overwrite) {
    throw UnavailableError(option + " " + there.front().string() +
                           " is there already: choose another name, or give --overwrite");
  }
  for (const fs::path& file : there) fs::remove(file);
  return path;
}

}  // namespace baton
