/// What of a recording's time a command takes: from and to in log time, in steps of the run, or in its simulated time.
///
/// By steps and by simulated time it takes what belongs to these steps, not what was logged while they were computed:
/// - a sample that carries its step (a message of the control loop, or of a foreign type with a member `step`),
/// by
///   that step;
/// - any other (events, requests, status, types without a step) by its log time, from the first to the last of those.
/// Of a run that was reset it is the last pass, as for `bag hash`.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "mcap/source.hpp"
#include "runtime/recorded_types.hpp"

namespace baton {

/// What is asked for, in one of the three ways; the whole recording when nothing is.
struct RangeWish {
  std::optional<double> from_s{};  // of log time, from the recording's first message
  std::optional<double> to_s{};
  std::optional<std::uint64_t> from_step{};
  std::optional<std::uint64_t> to_step{};
  std::optional<double> from_sim_s{};  // simulated time: step x length of a step
  std::optional<double> to_sim_s{};

  [[nodiscard]] bool isByStep() const { return from_step || to_step; }
  [[nodiscard]] bool isBySim() const { return from_sim_s || to_sim_s; }
  [[nodiscard]] bool isAll() const { return !from_s && !to_s && !isByStep() && !isBySim(); }
};

/// --from, --to, --from-step, --to-step, --from-sim and --to-sim.
void addRange(CLI::App& command, RangeWish& wish);
/// What they select, for a help text.
extern const char* const kRangeHelp;

/// Throws UsageError for a begin after the end, and for ways that are mixed.
void expectOneRange(const RangeWish& wish);

/// For topics and times in which a recording has no message; says what it has.
[[nodiscard]] UsageError nothingChosen(const mcap::Source& reader, const std::string& file);

/// The same, of a certain recording.
class RecordingRange {
 public:
  /// Reads the recording once when the range is one of steps. Throws UsageError for what expectOneRange() refuses and
  /// for a range in which the recording has nothing, and what reading a recording throws.
  /// @param reader  outlives this.
  RecordingRange(const RangeWish& wish, const mcap::Source& reader, const std::string& file);

  /// Log times of the first and the last that can be in it [ns].
  [[nodiscard]] std::uint64_t startTime() const { return start_ns_; }
  [[nodiscard]] std::uint64_t endTime() const { return end_ns_; }
  /// Whether a message between these two is in it.
  [[nodiscard]] bool takes(const mcap::MessageView& message);

 private:
  /// First and last step, both included.
  struct Steps {
    std::uint64_t from = 0;
    std::uint64_t to = std::numeric_limits<std::uint64_t>::max();
  };
  [[nodiscard]] std::optional<std::uint64_t> stepOf(const mcap::MessageView& message);
  [[nodiscard]] const schema::Type* steppedType(const mcap::Channel& channel, const mcap::Schema* schema);
  [[nodiscard]] Steps stepsAt(const RangeWish& wish, std::uint64_t begin_ns, const std::string& file) const;
  void findTimes(std::uint64_t begin_ns, const std::string& file);

  const mcap::Source& reader_;
  RecordedTypes types_{[](const std::string&) {}};  // whoever shows messages complains
  std::optional<Steps> steps_;
  std::uint64_t start_ns_ = 0;
  std::uint64_t end_ns_ = std::numeric_limits<std::uint64_t>::max();
};

}  // namespace baton
