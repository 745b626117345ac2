/// One writer on one topic, as the thread that writes the file knows it: found once, for all its samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "mcap/records.hpp"
#include "runtime/ledger.hpp"

namespace baton::dds {
struct TopicFacts;
}

namespace baton {

struct Stream {
  /// What the recorder itself learns from its samples.
  enum class Role : std::uint8_t { kOther, kRewind, kParameterStatus, kEvent };

  std::size_t index = 0;               // in the order they were found
  Ledger::Stream* received = nullptr;  // with topic and writer
  std::string type;
  const dds::TopicFacts* facts = nullptr;  // of a topic of Baton's
  mcap::StringMap metadata;                // of its channel
  Role role = Role::kOther;
  std::optional<std::size_t> credit;  // its place, when the plant waits for its steps
  bool is_recorded = true;            // not left out on purpose
  bool is_foreign = false;            // on a topic that is none of Baton's
  bool is_booked = true;              // so is what the account itself learns from
  bool is_status = false;
  bool is_manifest = false;          // what is sent at the end: kept in a pause as well
  std::uint64_t missing_so_far = 0;  // when its latest sample came
  std::uint64_t noticed = 0;         // of what is missing
  std::uint64_t lost_at = 0;         // steps of the run, when it was noticed last that samples never came
  std::size_t latched = 0;           // how many of its latest samples late joiners are given
  bool lasts = false;                // late joiners are given some of what was before
  std::int64_t found_ns = 0;         // when its writer was, since the epoch

  [[nodiscard]] const std::string& topic() const { return received->first.first; }
  [[nodiscard]] const dds::Guid& writer() const { return received->first.second; }

  /// What its channel takes in a file, about. Types of others have no text; Baton's are as many as in any run.
  [[nodiscard]] std::uint64_t declaredBytes() const {
    constexpr std::uint64_t kLengths = 8, kRecord = 32;
    std::uint64_t bytes = kRecord + topic().size();
    for (const auto& [name, value] : metadata) bytes += kLengths + name.size() + value.size();
    return bytes;
  }
  /// A sample has been booked at this step of the run. Returns how many of its writer never came between the one before
  /// and this.
  std::uint64_t booked(std::uint64_t elapsed_steps) {
    const ReceivedStream& account = received->second;
    const std::uint64_t lost_before = account.missing - std::exchange(missing_so_far, account.missing);
    const bool begins_late = account.count == 1 && account.first_sequence > 1;
    if (std::exchange(noticed, account.missing) < account.missing || begins_late) lost_at = elapsed_steps;
    return lost_before;
  }
  /// Some came at this step and found no room, which the account knows.
  void dropped(std::uint64_t elapsed_steps) {
    noticed = received->second.missing;
    lost_at = elapsed_steps;
  }
  /// What never came and is no loss of a file that began at this step: all of it, when it was noticed before that and
  /// none is missing between samples that are in the file.
  [[nodiscard]] std::uint64_t excusedIn(std::uint64_t begun_at, std::uint64_t missing_between) const {
    return lost_at < begun_at && missing_between == 0 ? received->second.neverRecorded() : 0;
  }
};

}  // namespace baton
