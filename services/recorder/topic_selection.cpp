#include "topic_selection.hpp"

#include <fnmatch.h>

#include <algorithm>

namespace baton {

bool TopicSelection::isRecorded(const std::string& topic) const {
  const auto matches = [&](const std::string& pattern) { return fnmatch(pattern.c_str(), topic.c_str(), 0) == 0; };
  return (topics.empty() || std::any_of(topics.begin(), topics.end(), matches)) &&
         std::none_of(except.begin(), except.end(), matches);
}

}  // namespace baton
