/// What of a run's traffic comes in before DDS looks at it. All writers of a topic share a reader's memory there, and
/// each reader that asks for repairs has them made by the thread of the loop: whoever has not the run's key may
/// therefore not get that far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <span>

#include "dds/run_key.hpp"
#include "dds/types.hpp"

namespace baton::dds {

/// What a participant with a key hears of those without it, apart from discovery.
enum class Strangers {
  kAsk,         // their acknowledgements and requests for repairs, so many a second of all together
  kAskFreely,   // all of these: what is written is for them
  kSpeakFreely  // their samples as well
};

/// Why something of a stranger is turned away.
enum class Trespass {
  kSpeaks,      // it sends samples
  kAsksTooMuch  // it asks for more repairs than are made for strangers
};

class Gate {
 public:
  /// Called once for each stranger and trespass, for so many of them, on the thread that asks.
  using Tell = std::function<void(const GuidPrefix&, Trespass)>;
  static constexpr std::size_t kMostTold = 1000;
  /// Of all strangers together: an acknowledgement counts one, and each sample it asks for one more.
  static constexpr std::int64_t kAsksPerSecond = 5000;

  Gate(const RunKey& key, Strangers strangers, Tell tell);

  /// Whether an RTPS message for readers and writers of the program is handed on to DDS. What is not RTPS is not. Any
  /// thread.
  [[nodiscard]] bool admits(std::span<const std::byte> message, std::int64_t now_ns);
  /// Messages that were not.
  [[nodiscard]] std::uint64_t turnedAway() const;

 private:
  [[nodiscard]] bool isMember(const GuidPrefix& sender);
  [[nodiscard]] bool mayAsk(std::int64_t asks, std::int64_t now_ns);
  void turnAway(const GuidPrefix& sender, Trespass what);

  const RunKey key_;
  const Strangers strangers_;
  const Tell tell_;
  mutable std::mutex mutex_;
  std::set<GuidPrefix> members_;  // marks cannot be made in number
  std::set<std::pair<GuidPrefix, Trespass>> told_;
  std::int64_t asks_left_ = kAsksPerSecond;
  std::int64_t counted_at_ns_ = 0;
  std::uint64_t turned_away_ = 0;
};

}  // namespace baton::dds
