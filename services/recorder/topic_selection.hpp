/// Which topics a recording is to hold: those that a pattern of `topics` allows (all, when there is none) and none of
/// `except` takes away. Patterns are those of a shell: * ? [a-z].
#pragma once

#include <string>
#include <vector>

namespace baton {

struct TopicSelection {
  std::vector<std::string> topics;
  std::vector<std::string> except;

  [[nodiscard]] bool isRecorded(const std::string& topic) const;
};

}  // namespace baton
