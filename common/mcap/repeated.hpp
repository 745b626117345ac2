/// What a recording that begins in the middle repeats from before its beginning: the samples that topics keep for late
/// joiners (transient local), as whoever had joined there would have got them.
///
/// They are the first messages of the file, all with the log time of its beginning; sequence numbers, publish times and
/// bytes are those of the originals. The metadata record `baton.latched` says how many there are. They are no part of
/// what was recorded from there on: accounts leave them out, and so does whoever has the file in which they were
/// recorded.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mcap/source.hpp"

namespace baton::mcap {

class Reader;

inline constexpr const char* kRepeatedRecord = "baton.latched";

class Repeated {
 public:
  Repeated() = default;
  /// Of one file; reads their chunks. Nothing when the file repeats nothing.
  explicit Repeated(const Reader& file);
  /// Only those that one of the files before it has, by their times: on the same channel (topic, type, metadata), in a
  /// file that ends no earlier than they were published, and that or its channel's first message is no later.
  Repeated(const Reader& file, const std::vector<const Reader*>& before);

  /// Whether the next message of a pass over the file is one of them. Messages of a channel come in their order.
  [[nodiscard]] bool takes(const MessageView& message);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] const std::map<ChannelId, std::uint64_t>& counts() const { return counts_; }

 private:
  template <class IsMeant>
  void read(const Reader& file, const IsMeant& is_meant);

  struct Beginning {
    std::vector<bool> is_meant;  // of the messages that the file repeats, in their order
    std::size_t passed = 0;
  };
  std::uint64_t count_ = 0;
  std::uint64_t log_time_ns_ = 0;
  std::map<ChannelId, std::uint64_t> counts_;
  std::map<ChannelId, Beginning> beginnings_;
};

/// The record's values.
[[nodiscard]] StringMap repeatedRecord(std::uint64_t messages);

}  // namespace baton::mcap
