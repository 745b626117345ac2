#include "runtime/recorded_qos.hpp"

#include <sstream>
#include <utility>

#include "mcap/lookup.hpp"

namespace baton {
using mcap::valueOf;

/// The recorded QoS, from lines of "name: value". "qos" is what eProsima's DDS Record & Replay keeps too, four truth
/// values, and in our older recordings words; "qos_policies" has words, for all that is known of the writer.
std::map<std::string, std::string> recordedQos(const mcap::StringMap& metadata) {
  static const std::map<std::string, std::pair<const char*, const char*>> kWords{
      {"reliability", {"reliable", "best_effort"}},
      {"durability", {"transient_local", "volatile"}},
      {"ownership", {"exclusive", "shared"}}};
  std::map<std::string, std::string> values;
  std::istringstream lines(valueOf(metadata, "qos") + "\n" + valueOf(metadata, "qos_policies"));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    std::string key = line.substr(0, colon), value = line.substr(colon + 2);
    if (const auto words = kWords.find(key); words != kWords.end()) {
      if (value == "true") value = words->second.first;
      if (value == "false") value = words->second.second;
    }
    values[std::move(key)] = std::move(value);
  }
  return values;
}

}  // namespace baton
