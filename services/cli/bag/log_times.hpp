/// Whether the log times of a recording are those of a clock that ran on: `baton bag info` and `verify`.
///
/// A clock that is set while it is used leaves a hole (set forwards), times that go back (set back), or many messages
/// with one time (set back, by a recorder that lets no time decrease). A hole looks like a pause of all writers, so it
/// is named and not judged.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mcap/records.hpp"

namespace baton {

class LogTimes {
 public:
  /// In the file's order, which need not be that of time. Memory is bounded.
  void add(mcap::ChannelId channel_id, std::uint64_t log_time_ns);
  /// What follows is of another part of the recording, with channels of its own.
  void nextFile() { channels_.clear(); }
  /// A sentence for each kind of jump; none for a clock that ran on.
  [[nodiscard]] std::vector<std::string> findings() const;

 private:
  struct Channel {
    std::uint64_t last_ns = 0;
    std::uint64_t repeated = 0;  // messages with that time, without interruption
  };
  struct Jump {
    std::uint64_t amount = 0;
    std::uint64_t at_ns = 0;
  };

  void extend(std::uint64_t log_time_ns);
  [[nodiscard]] std::string holesText() const;
  [[nodiscard]] std::string secondsText(std::uint64_t log_time_ns) const;

  std::uint64_t messages_ = 0;
  std::vector<Channel> channels_;                     // [id]
  std::map<std::uint64_t, std::uint64_t> stretches_;  // of time without a hole: first message, last one
  Jump back_{};                                       // the farthest one of a channel [ns]
  Jump still_{};                                      // most messages of a channel with one time
};

}  // namespace baton
