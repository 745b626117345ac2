/// Which topics a recording is to hold: those that a pattern of `topics` allows (all, when there is none) and none of
/// `except` takes away. Patterns are those of a shell: * ? [a-z]. Foreign topics, those that are none of Baton's, can
/// be left out altogether.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace baton {

struct TopicSelection {
  std::vector<std::string> topics;
  std::vector<std::string> except;
  bool takes_foreign = true;

  [[nodiscard]] bool isRecorded(const std::string& topic) const;
  /// What of `topics` none of these matches: each may be a slip of the pen, and costs what was to be recorded. (What is
  /// to be left out and is not there may just have had no writer.)
  [[nodiscard]] std::vector<std::string> unmatched(const std::set<std::string>& found) const;
};

}  // namespace baton
