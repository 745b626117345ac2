#include "runtime/recording_parts.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

namespace baton {
namespace fs = std::filesystem;

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

}  // namespace baton
