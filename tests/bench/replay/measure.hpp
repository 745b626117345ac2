/// What is measured.
#pragma once

#include <string>
#include <vector>

#include "../loop/programs.hpp"
#include "time/histogram.hpp"

namespace baton::bench {

/// A loop that sleeps until each millisecond and does nothing: how late the machine wakes anybody [ns].
[[nodiscard]] Histogram sleepThrough(int ticks);

struct Replay {
  nlohmann::json summary;    // of the replayer
  Histogram interval_error;  // at a reader: how far two arrivals are from a millisecond apart [ns]
};
/// A recording at 1 kHz, replayed to a reader in this process. Throws when messages are missing.
[[nodiscard]] Replay replayOnce(Programs& programs, const std::string& file, int ticks,
                                const std::vector<std::string>& options);

/// From the request to the next message being in memory, at places all over the recording [ns].
[[nodiscard]] Histogram seekAround(const std::string& file, int times);

}  // namespace baton::bench
