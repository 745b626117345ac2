#include "runtime/announcer.hpp"

#include <algorithm>
#include <utility>

namespace baton {
namespace {

constexpr std::chrono::milliseconds kFirstPause{200}, kLongestPause{4000}, kGreetingDelay{100};

}  // namespace

void Announcer::repeatUntil(std::function<bool()> is_done) {
  is_done_ = std::move(is_done);
  searchAfter(kFirstPause);
}

void Announcer::searchAfter(std::chrono::milliseconds pause) {
  search_.expires_after(pause);
  search_.async_wait([this, pause](const boost::system::error_code& error) {
    if (error || is_done_()) return;
    participant_.announce();
    searchAfter(std::min(2 * pause, kLongestPause));
  });
}

void Announcer::greet() {
  if (std::exchange(is_greeting_, true)) return;
  greeting_.expires_after(kGreetingDelay);
  greeting_.async_wait([this](const boost::system::error_code& error) {
    is_greeting_ = false;
    if (!error) participant_.announce();
  });
}

}  // namespace baton
