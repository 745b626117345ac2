#include "audience.hpp"

#include <algorithm>

namespace baton {
namespace {

std::string listed(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::string Audience::missing(const Readers& readers, std::int64_t now_ns) {
  if (seen_ != readers) {
    seen_ = readers;
    changed_ns_ = now_ns;
  }
  std::set<std::string> unread;
  std::set<std::string> unheard(names_.begin(), names_.end());
  for (const auto& [topic, processes] : readers) {
    if (processes.size() < count_) unread.insert(topic);
    for (const auto& [prefix, name] : processes) unheard.erase(name);
  }
  if (!unheard.empty()) return listed(unheard) + " to read a topic";
  if (!unread.empty()) return std::to_string(count_) + " reading processes on " + listed(unread);
  const bool is_settled = names_.empty() || now_ns - changed_ns_ >= kSettled_ns;
  return is_settled ? "" : "the last readers of " + listed({names_.begin(), names_.end()});
}

}  // namespace baton
