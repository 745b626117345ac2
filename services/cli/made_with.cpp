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

std::string toText(const std::vector<MadeWithDifference>& differences) {
  std::string text, unsaid;
  for (const MadeWithDifference& one : differences) {
    if (one.then.empty() || one.now.empty()) {
      unsaid += (unsaid.empty() ? "" : ", ") + one.key;
    } else {
      text += (text.empty() ? "" : "; ") + one.key + ": " + one.then + " in the recording, " + one.now + " now";
    }
  }
  if (!unsaid.empty()) text += (text.empty() ? "" : "; ") + ("one of the two does not say its " + unsaid);
  return text;
}

}  // namespace baton
