/// The replay's own topics: what operators ask, what they are answered, how it stands.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <vector>

#include "dds/typed.hpp"

namespace baton {

class Remote {
 public:
  /// @param heard       whose requests count.
  /// @param on_request  called when there is something to take, on a DDS thread.
  Remote(dds::Participant& participant, dds::WriterFilter heard, std::function<void()> on_request);

  /// The requests that came since this was asked last.
  [[nodiscard]] std::vector<msg::ReplayRequest> take();
  void answer(const msg::ReplayReply& reply) { replies_.write(reply); }
  void tell(const msg::ReplayStatus& status) { status_.write(status); }
  /// Waits, for a second or two at most, until everybody has what was said last, also who asked just before.
  void sayGoodbye();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<msg::ReplayRequest> requests_;
  struct Asker {
    dds::GuidPrefix prefix{};
    std::chrono::steady_clock::time_point since;  // long ago: nobody
  };
  Asker asker_;  // who asked last
  dds::Writer<msg::ReplayStatus> status_;
  dds::Writer<msg::ReplayReply> replies_;
  dds::Reader<msg::ReplayRequest> reader_;
};

}  // namespace baton
