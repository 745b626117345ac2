#include "remote.hpp"

#include <chrono>
#include <utility>

namespace baton {

Remote::Remote(dds::Participant& participant, dds::WriterFilter heard, std::function<void()> on_request)
    : status_(participant, dds::topics::kReplayStatus),
      replies_(participant, dds::topics::kReplayReply,
               [this] {
                 const std::lock_guard lock(mutex_);
                 changed_.notify_all();
               }),
      reader_(
          participant, dds::topics::kReplayRequest,
          [this, &participant, on_request = std::move(on_request)](const msg::ReplayRequest& request,
                                                                   const dds::RawSample& sample) {
            // What DDS remembers from before was asked of another replay of this run.
            if (sample.source_timestamp_ns < participant.self().started_ns) return;
            {
              const std::lock_guard lock(mutex_);
              requests_.push_back(request);
              asker_ = {.prefix = dds::prefixOf(sample.writer), .since = std::chrono::steady_clock::now()};
            }
            on_request();
          },
          {}, std::move(heard)) {}

std::vector<msg::ReplayRequest> Remote::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

void Remote::sayGoodbye() {
  constexpr std::chrono::milliseconds kPatience{1000};
  {
    // An asker sees the writer of the answers before that one sees it: what was answered may still wait for the match.
    // Who asked longer ago has the answer, or has gone.
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, asker_.since + kPatience,
                        [this] { return replies_.raw().matched().contains(asker_.prefix); });
  }
  replies_.raw().waitForAcknowledgments(kPatience.count());
  status_.raw().waitForAcknowledgments(kPatience.count());
}

}  // namespace baton
