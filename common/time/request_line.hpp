/// Requests that wait for their time. Timers may run out late and in any order: whichever does, the request of that
/// asker that came first has its turn.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <utility>

#include "time/request_pace.hpp"

namespace baton {

class RequestLine {
 public:
  using Asker = RequestPace::Asker;
  using Action = std::function<void()>;

  /// Whether one of this asker waits: another one waits after it then, even if its own time is now.
  [[nodiscard]] bool isWaiting(const Asker& asker) const { return waiting_.contains(asker); }
  /// The last of its asker's. next() is called once for each.
  void add(const Asker& asker, Action action) { waiting_[asker].push_back(std::move(action)); }
  /// Takes the first of this asker's, of which there is one.
  [[nodiscard]] Action next(const Asker& asker) {
    const auto line = waiting_.find(asker);
    Action action = std::move(line->second.front());
    line->second.pop_front();
    if (line->second.empty()) waiting_.erase(line);
    return action;
  }

 private:
  std::map<Asker, std::deque<Action>> waiting_;
};

}  // namespace baton
