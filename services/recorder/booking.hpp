/// How a sample gets into the account of its writer.
#pragma once

#include <cstddef>
#include <span>

#include "runtime/ledger.hpp"
#include "sample_queue.hpp"
#include "stream.hpp"

namespace baton {

/// Returns whether it is to be kept: it has data and has not come before.
[[nodiscard]] inline bool book(Ledger& ledger, const Stream& stream, const SampleQueue::Entry& entry,
                               std::span<const std::byte> payload) {
  Ledger::Stream& account = *stream.received;
  if (!entry.has_data) {
    ledger.passOver(account, entry.sequence, entry.sequence);
    return false;
  }
  // What a writer keeps for late joiners may have holes, the latest of each key for one. Nothing in them was lost.
  const bool is_history = stream.lasts && entry.source_timestamp_ns < stream.found_ns;
  if (is_history && entry.sequence > 0) {
    ledger.passOver(account, account.second.last_sequence + 1, entry.sequence - 1);
  }
  return ledger.book(account, entry.sequence, payload);
}

}  // namespace baton
