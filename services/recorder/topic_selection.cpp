#include "topic_selection.hpp"

#include <fnmatch.h>

#include <algorithm>

#include "dds/topics.hpp"

namespace baton {
namespace {

bool isMatch(const std::string& pattern, const std::string& topic) {
  return fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
}

}  // namespace

bool TopicSelection::isRecorded(const std::string& topic) const {
  const auto matches = [&](const std::string& pattern) { return isMatch(pattern, topic); };
  if (!takes_foreign && dds::isForeignTopic(topic)) return false;
  return (topics.empty() || std::any_of(topics.begin(), topics.end(), matches)) &&
         std::none_of(except.begin(), except.end(), matches);
}

std::vector<std::string> TopicSelection::unmatched(const std::set<std::string>& found) const {
  std::vector<std::string> result;
  for (const std::string& pattern : topics) {
    const auto matches = [&](const std::string& topic) {
      return isMatch(pattern, topic) && (takes_foreign || !dds::isForeignTopic(topic));
    };
    if (std::none_of(found.begin(), found.end(), matches)) result.push_back(pattern);
  }
  return result;
}

}  // namespace baton
