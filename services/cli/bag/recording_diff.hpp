/// Two recordings, sample by sample: `baton bag diff`.
///
/// Samples are paired by topic, service (the GUIDs of writers differ from run to run) and, where messages have a
/// `step`, by step, else by their order; a step that occurs again after a later one belongs to the next take. Both
/// files are walked through side by side, the one that is behind first: what is held is a chunk of each and the samples
/// that wait for their counterpart, which is how far the two recordings are out of step.
///
/// Of a run that was reset the last take is compared, as by `hash`, `metrics` and `rerun`, unless all are asked for.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bag/field_rules.hpp"
#include "bag/message_diff.hpp"
#include "mcap/joined_reader.hpp"

namespace baton {

struct DiffRequest {
  mcap::FileList a{};
  mcap::FileList b{};
  std::vector<std::string> topics{};       // empty: those of the control loop; without any, all but *_status
  std::vector<std::string> ignored{};      // as RuleSet
  std::vector<std::string> tolerances{};   // as RuleSet
  bool all_takes = false;                  // those before a reset too
  std::uint64_t from_step = 0;             // of messages that have one, only those from here on
  std::optional<std::uint64_t> to_step{};  // and up to here
};

/// Where a sample stands among those of its stream.
struct Position {
  std::uint64_t take = 0;             // how often the step had gone back
  std::optional<std::uint64_t> step;  // nothing when messages have none
  std::uint64_t index = 0;            // among those of the step, or of the stream when there are no steps
  auto operator<=>(const Position&) const = default;
};

struct FirstDifference {
  Position at;
  std::uint64_t log_time_ns = 0;  // in the recording that has it
  FieldDifference what;
};

struct StreamDiff {
  std::uint64_t compared = 0;
  std::uint64_t different = 0;
  std::uint64_t only_a = 0;
  std::uint64_t only_b = 0;
  std::optional<FirstDifference> first;
  [[nodiscard]] bool isSame() const { return different == 0 && only_a == 0 && only_b == 0; }
};

using StreamKey = std::pair<std::string, std::string>;  // topic, service

struct RecordingDiff {
  std::map<StreamKey, StreamDiff> streams;
  std::vector<std::string> left_out;             // topics of either file
  std::array<std::uint32_t, 2> resets_before{};  // of A and B: how often the run was reset before what is compared
  std::array<std::optional<std::uint64_t>, 2> first_step{};  // of A and B, in what is compared
  std::vector<std::string> warnings;
  [[nodiscard]] bool isSame() const;
  /// The first step that both have, where one begins later, as a branch does.
  [[nodiscard]] std::optional<std::uint64_t> laterBegin() const;
  /// The stream that differs first: by step, then by log time. Nothing when all is the same.
  [[nodiscard]] std::optional<StreamKey> firstDifferent() const;
};

/// Throws UsageError for a file that cannot be read whole, for topics and rules that are about nothing in the two, and
/// when there is nothing to compare, in the steps asked for; UnavailableError for a file that cannot be opened.
/// @param progress  told how much of both has been read, 0 to 1.
[[nodiscard]] RecordingDiff diffRecordings(const DiffRequest& request, const std::function<void(double)>& progress);

}  // namespace baton
