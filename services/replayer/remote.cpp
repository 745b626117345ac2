#include "remote.hpp"

#include <chrono>
#include <utility>

namespace baton {

Remote::Remote(dds::Participant& participant, std::function<void()> on_request)
    : status_(participant, dds::topics::kReplayStatus),
      replies_(participant, dds::topics::kReplayReply,
               [this] {
                 const std::lock_guard lock(mutex_);
                 changed_.notify_all();
               }),
      reader_(participant, dds::topics::kReplayRequest,
              [this, &participant, on_request = std::move(on_request)](const msg::ReplayRequest& request,
                                                                       const dds::RawSample& sample) {
                // What DDS remembers from before was asked of another replay of this run.
                if (sample.source_timestamp_ns < participant.self().started_ns) return;
                {
                  const std::lock_guard lock(mutex_);
                  requests_.push_back(request);
                  if (request.action() == msg::REPLAY_STOP) ender_ = dds::prefixOf(sample.writer);
                }
                on_request();
              }) {}

std::vector<msg::ReplayRequest> Remote::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

void Remote::sayGoodbye() {
  constexpr std::chrono::milliseconds kPatience{1000};
  {
    // An asker sees the writer of the answers before that one sees it: what was answered may still wait for the match.
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPatience, [this] { return !ender_ || replies_.raw().matched().contains(*ender_); });
  }
  replies_.raw().waitForAcknowledgments(kPatience.count());
  status_.raw().waitForAcknowledgments(kPatience.count());
}

}  // namespace baton
