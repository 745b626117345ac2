#include "made_with.hpp"

#include "mcap/lookup.hpp"

namespace baton {

std::vector<MadeWithDifference> madeWithDifferences(const mcap::StringMap& then, const mcap::StringMap& now) {
  std::vector<MadeWithDifference> differences;
  for (const char* key : {"version", "build_id", "mathematics", "compiler", "flags", "processor", "libc", "dds"}) {
    MadeWithDifference values{key, mcap::valueOf(then, key), mcap::valueOf(now, key)};
    if (values.then != values.now) differences.push_back(std::move(values));
  }
  return differences;
}

std::string toText(const MadeWithDifference& difference) {
  const auto orUnknown = [](const std::string& value) { return value.empty() ? "unknown" : value; };
  return difference.key + ": " + orUnknown(difference.then) + " in the recording, " + orUnknown(difference.now) +
         " now";
}

}  // namespace baton
