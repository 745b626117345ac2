#include "remote.hpp"

#include <utility>

namespace baton {

Remote::Remote(dds::Participant& participant, std::function<void()> on_request)
    : status_(participant, dds::topics::kReplayStatus),
      replies_(participant, dds::topics::kReplayReply),
      reader_(participant, dds::topics::kReplayRequest,
              [this, &participant, on_request = std::move(on_request)](const msg::ReplayRequest& request,
                                                                       const dds::RawSample& sample) {
                // What DDS remembers from before was asked of another replay of this run.
                if (sample.source_timestamp_ns < participant.self().started_ns) return;
                {
                  const std::lock_guard lock(mutex_);
                  requests_.push_back(request);
                }
                on_request();
              }) {}

std::vector<msg::ReplayRequest> Remote::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

void Remote::sayGoodbye() {
  status_.raw().waitForAcknowledgments(1000);
  replies_.raw().waitForAcknowledgments(1000);
}

}  // namespace baton
