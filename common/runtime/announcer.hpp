/// When a process announces itself again to the others, beyond what DDS does. From the executor.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>

#include "dds/participant.hpp"

namespace baton {

class Announcer {
 public:
  Announcer(boost::asio::io_context& executor, dds::Participant& participant)
      : participant_(participant), search_(executor), greeting_(executor) {}

  /// A peer may have missed the first announcement. Pauses double up to 4 s, so that many services that start together
  /// do not flood each other.
  void repeatUntil(std::function<bool()> is_done);
  /// A new participant sends its first announcement before it can receive, so it may miss the answer of DDS. Announces
  /// once, 100 ms later, for all that join in that time.
  void greet();

 private:
  void searchAfter(std::chrono::milliseconds pause);

  dds::Participant& participant_;
  std::function<bool()> is_done_;
  boost::asio::steady_timer search_;
  boost::asio::steady_timer greeting_;
  bool is_greeting_ = false;
};

}  // namespace baton
