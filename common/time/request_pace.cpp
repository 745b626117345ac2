#include "time/request_pace.hpp"

#include <algorithm>

namespace baton {

std::optional<std::int64_t> RequestPace::admit(const Asker& asker, std::int64_t now_ns) {
  if (even_at_.size() >= kManyAskers) {
    std::erase_if(even_at_, [now_ns](const auto& entry) { return entry.second <= now_ns; });
  }
  std::int64_t& even_at_ns = even_at_.try_emplace(asker, now_ns).first->second;
  const std::int64_t next_ns = std::max(even_at_ns, now_ns) + kInterval_ns;
  const std::int64_t due_ns = std::max(now_ns, next_ns - kAtOnce * kInterval_ns);
  if (due_ns - now_ns > kLongestWait_ns) return std::nullopt;
  even_at_ns = next_ns;
  return due_ns;
}

}  // namespace baton
