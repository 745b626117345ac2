#include "mcap/lookup.hpp"

#include <algorithm>
#include <limits>
#include <set>

namespace baton::mcap {

std::string valueOf(const StringMap& map, const std::string& key) {
  const auto found = map.find(key);
  return found == map.end() ? "" : found->second;
}

std::string incompletenessOf(const FileInfo& info) {
  if (info.is_complete) return "";
  return info.is_cut ? "it was cut: " + info.problem : info.problem;
}

std::vector<std::string> topicNames(const Source& reader) {
  std::set<std::string> names;
  for (const auto& [id, channel] : reader.channels()) names.insert(channel.topic);
  return {names.begin(), names.end()};
}

double durationOf(const Source& reader) {
  return static_cast<double>(reader.statistics().end_time_ns - reader.statistics().start_time_ns) * 1e-9;
}

std::uint64_t logTimeAt(const Source& reader, double seconds) {
  constexpr double kLongest_ns = 9e18;  // fits into 64 bits
  const std::uint64_t start_ns = reader.statistics().start_time_ns;
  const auto since_ns = static_cast<std::uint64_t>(std::min(seconds * 1e9, kLongest_ns));
  return start_ns + std::min(since_ns, std::numeric_limits<std::uint64_t>::max() - start_ns);
}

}  // namespace baton::mcap
