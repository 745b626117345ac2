/// How a sample gets into the account of its writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dds/topics.hpp"
#include "discovery.hpp"
#include "runtime/latched.hpp"
#include "runtime/ledger.hpp"
#include "sample_queue.hpp"
#include "stream.hpp"

namespace baton {

/// What a writer keeps for late joiners comes within this time of finding it. Both times are of the recorder's clock:
/// the clock of the writer may be wrong, and a replay sends the source times of its recording.
inline constexpr std::int64_t kHistoryPatience_ns = 2'000'000'000;

/// Notes what is known of a writer when its first sample is met.
/// @param repeats  later files of the recording begin with what the writer keeps for late joiners.
inline void introduce(Stream& stream, std::size_t index, const TopicReaders::Writer& facts, const dds::Guid& writer,
                      bool repeats, Ledger& ledger) {
  stream.index = index;
  stream.received = &ledger.streamOf({facts.topic, writer});
  stream.type = facts.type;
  stream.metadata = facts.metadata;
  stream.facts = batonTopic(facts.topic, facts.metadata);
  stream.is_foreign = dds::isForeignTopic(facts.topic);
  const bool is_kept = repeats && (facts.lasts || announcesReset(stream.facts));
  stream.latched = is_kept ? latchedDepth(facts.topic, facts.metadata) : 0;
  stream.lasts = facts.lasts;
  stream.found_ns = facts.found_ns;
}

/// Returns whether it is to be kept: it has data and has not come before.
[[nodiscard]] inline bool book(Ledger& ledger, const Stream& stream, const SampleQueue::Entry& entry,
                               std::span<const std::byte> payload) {
  Ledger::Stream& account = *stream.received;
  if (!entry.has_data) {
    ledger.passOver(account, entry.sequence, entry.sequence);
    return false;
  }
  // What a writer keeps for late joiners may have holes, the latest of each key for one. Nothing in them was lost.
  const bool is_history = stream.lasts && entry.log_time_ns - stream.found_ns < kHistoryPatience_ns;
  if (is_history && entry.sequence > 0) {
    ledger.passOver(account, account.second.last_sequence + 1, entry.sequence - 1);
  }
  return ledger.book(account, entry.sequence, payload);
}

}  // namespace baton
