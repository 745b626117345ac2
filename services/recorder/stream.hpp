/// One writer on one topic, as the thread that writes the file knows it: found once, for all its samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "mcap/records.hpp"
#include "runtime/ledger.hpp"

namespace baton {

struct Stream {
  /// What the recorder itself learns from its samples.
  enum class Role : std::uint8_t { kOther, kRewind, kParameterStatus, kEvent };

  std::size_t index = 0;               // in the order they were found
  Ledger::Stream* received = nullptr;  // with topic and writer
  std::string type;
  mcap::StringMap metadata;  // of its channel
  Role role = Role::kOther;
  std::optional<std::size_t> credit;  // its place, when the plant waits for its steps
  bool is_recorded = true;            // not left out on purpose
  bool is_booked = true;              // so is what the account itself learns from
  bool is_status = false;
  bool is_manifest = false;          // what is sent at the end: kept in a pause as well
  std::uint64_t missing_so_far = 0;  // of what came, when its latest sample came
  std::uint64_t lost_at = 0;         // steps of the run, when it was noticed last that samples are missing
  bool lasts = false;                // late joiners are told of what was before

  [[nodiscard]] const std::string& topic() const { return received->first.first; }
  [[nodiscard]] const dds::Guid& writer() const { return received->first.second; }
};

}  // namespace baton
