#include "runtime/recording_range.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "dds/topics.hpp"
#include "mcap/lookup.hpp"
#include "runtime/command_line.hpp"
#include "runtime/recorded_messages.hpp"
#include "runtime/recorded_take.hpp"
#include "schema/step.hpp"

namespace baton {
namespace {

constexpr const char* kWhatToChoose = "choose a part of that (`baton bag info` lists the topics)";

constexpr std::uint64_t kLast = std::numeric_limits<std::uint64_t>::max();

/// Events and statuses of Baton say which step was open when they were made; they belong to none.
bool mayCarryStep(const std::string& topic) {
  const dds::TopicFacts* facts = dds::topics::called(topic);
  return facts == nullptr || facts->profile == dds::Profile::kLoop;
}

template <class T>
void expectOrder(const std::optional<T>& from, const std::optional<T>& to, const char* suffix, const char* what) {
  if (!from || !to || *to >= *from) return;
  throw UsageError(
      fmt::format("--to{0}: expected {1} that is not before --from{0} {2}, found {3}; exchange the two, or "
                  "leave one of them out",
                  suffix, what, *from, *to));
}

/// Seconds as they are typed, to the nanosecond; the latest there is, for what is beyond it.
std::int64_t nanoseconds(double seconds) {
  constexpr double kLongest_s = 9.2e9;
  return std::llround(std::min(seconds, kLongest_s) * 1e9);
}

/// The smallest and the largest of what was met.
struct Spread {
  std::uint64_t first = kLast;
  std::uint64_t last = 0;
  void meet(std::uint64_t value) {
    first = std::min(first, value);
    last = std::max(last, value);
  }
  [[nodiscard]] bool isEmpty() const { return first > last; }
};

std::string passText(std::uint64_t begin_ns) { return begin_ns > 0 ? ", in its last pass after a reset," : ""; }

}  // namespace

const char* const kRangeHelp =
    "Ranges: --from-step and --to-step take every sample of the control loop by the step it carries (also of foreign\n"
    "types with a member `unsigned long long step`), --from-sim and --to-sim the same by simulated time, step x\n"
    "length of a step. Events, requests, statuses and samples without a step are taken by log time, from the\n"
    "first to the last sample that was taken by its step. Of a run that was reset both take the last pass, as\n"
    "`bag hash` does.\n";

void addRange(CLI::App& command, RangeWish& wish) {
  command.add_option("--from", wish.from_s, "start here, in s of log time from the recording's first message")
      ->check(notNegative());
  command.add_option("--to", wish.to_s, "end here, likewise; a message at that time is taken")->check(notNegative());
  command.add_option("--from-step", wish.from_step, "start with this step of the run");
  command.add_option("--to-step", wish.to_step, "end with this step");
  command.add_option("--from-sim", wish.from_sim_s, "start here, in s of simulated time")->check(notNegative());
  command.add_option("--to-sim", wish.to_sim_s, "end here, likewise; a step at that time is taken")
      ->check(notNegative());
}

void expectOneRange(const RangeWish& wish) {
  if (int{wish.from_s || wish.to_s} + int{wish.isByStep()} + int{wish.isBySim()} > 1) {
    throw UsageError(
        "expected a range of one kind, log time (--from, --to), steps (--from-step, --to-step) or simulated time "
        "(--from-sim, --to-sim), found several");
  }
  expectOrder(wish.from_s, wish.to_s, "", "a time");
  expectOrder(wish.from_step, wish.to_step, "-step", "a step");
  expectOrder(wish.from_sim_s, wish.to_sim_s, "-sim", "a time");
}

UsageError nothingChosen(const mcap::Source& reader, const std::string& file) {
  return UsageError(fmt::format("expected messages in these topics and times, found none: {} has {} in {:.6f} s; {}",
                                file, reader.statistics().message_count, mcap::durationOf(reader), kWhatToChoose));
}

RecordingRange::RecordingRange(const RangeWish& wish, const mcap::Source& reader, const std::string& file)
    : reader_(reader) {
  expectOneRange(wish);
  if (wish.isByStep() || wish.isBySim()) {
    const std::uint64_t begin_ns = lastTakeBegin(reader);
    steps_ = wish.isBySim() ? stepsAt(wish, begin_ns, file)
                            : Steps{wish.from_step.value_or(0), wish.to_step.value_or(kLast)};
    findTimes(begin_ns, file);
    return;
  }
  if (wish.from_s) start_ns_ = mcap::logTimeAt(reader, *wish.from_s);
  if (wish.to_s) end_ns_ = mcap::logTimeAt(reader, *wish.to_s);
  if (start_ns_ > reader.statistics().end_time_ns) {
    throw UsageError(
        fmt::format("--from: expected a time in {}, which ends {:.6f} s after its first message, found {}; {}", file,
                    mcap::durationOf(reader), *wish.from_s, kWhatToChoose));
  }
}

/// The plant says of each step when it was.
RecordingRange::Steps RecordingRange::stepsAt(const RangeWish& wish, std::uint64_t begin_ns,
                                              const std::string& file) const {
  const std::int64_t from_ns = nanoseconds(wish.from_sim_s.value_or(0.0));
  const std::int64_t to_ns = wish.to_sim_s ? nanoseconds(*wish.to_sim_s) : std::numeric_limits<std::int64_t>::max();
  Spread wanted, times;
  forEachMessageOf(dds::topics::kPlantState, reader_, begin_ns, [&](const msg::PlantState& state, const auto&) {
    times.meet(static_cast<std::uint64_t>(std::max<std::int64_t>(state.time_ns(), 0)));
    if (state.time_ns() >= from_ns && state.time_ns() <= to_ns) wanted.meet(state.step());
  });
  if (times.isEmpty()) {
    throw UsageError(
        fmt::format("{}: expected states of the plant (topic {}), which say when a step was in simulated "
                    "time, found none; --from-step and --to-step, or --from and --to, do without",
                    file, dds::topics::kPlantState.name));
  }
  if (wanted.isEmpty()) {
    throw UsageError(
        fmt::format("--from-sim, --to-sim: expected times with a step in {}, which{} goes from {:.9g} to "
                    "{:.9g} s of simulated time, found {:.9g} to {}; {}",
                    file, passText(begin_ns), static_cast<double>(times.first) * 1e-9,
                    static_cast<double>(times.last) * 1e-9, wish.from_sim_s.value_or(0.0),
                    wish.to_sim_s ? fmt::format("{:.9g}", *wish.to_sim_s) : "its end", kWhatToChoose));
  }
  return {wanted.first, wanted.last};
}

/// Log times of the first and the last sample with one of the steps.
void RecordingRange::findTimes(std::uint64_t begin_ns, const std::string& file) {
  mcap::MessageFilter filter{.start_time_ns = begin_ns, .order = mcap::MessageFilter::Order::kFile};
  for (const auto& [id, channel] : reader_.channels()) {
    const auto schema = reader_.schemas().find(channel.schema_id);
    if (schema != reader_.schemas().end() && steppedType(channel, &schema->second) != nullptr) {
      filter.channels.push_back(id);
    }
  }
  Spread times, steps;
  if (!filter.channels.empty()) {  // an empty filter would be all
    reader_.forEachMessage(filter, [&](const mcap::MessageView& message) {
      const std::optional<std::uint64_t> step = stepOf(message);
      if (!step) return;
      steps.meet(*step);
      if (*step >= steps_->from && *step <= steps_->to) times.meet(message.log_time_ns);
    });
  }
  if (steps.isEmpty()) {
    throw UsageError(file + ": expected samples that carry a step, found none: choose times with --from and --to");
  }
  if (times.isEmpty()) {
    const bool is_between = steps_->from >= steps.first && steps_->to <= steps.last;
    throw UsageError(fmt::format(
        "--from-step, --to-step: expected steps that {} has, which{} are {} to {}{}, found {} to {}; {}", file,
        passText(begin_ns), steps.first, steps.last, is_between ? " with gaps (parts may be missing)" : "",
        steps_->from, steps_->to == kLast ? "its end" : std::to_string(steps_->to), kWhatToChoose));
  }
  start_ns_ = times.first;
  end_ns_ = times.last;
}

/// Null when messages of the channel do not say their step.
const schema::Type* RecordingRange::steppedType(const mcap::Channel& channel, const mcap::Schema* schema) {
  if (!mayCarryStep(channel.topic)) return nullptr;
  const schema::Type* type = types_.typeOf(channel, schema);
  return type != nullptr && schema::hasStep(*type) ? type : nullptr;
}

std::optional<std::uint64_t> RecordingRange::stepOf(const mcap::MessageView& message) {
  const schema::Type* type = steppedType(*message.channel, message.schema);
  return type == nullptr ? std::nullopt : schema::stepOf(*type, message.data);
}

bool RecordingRange::takes(const mcap::MessageView& message) {
  if (!steps_) return true;
  const std::optional<std::uint64_t> step = stepOf(message);
  return !step || (*step >= steps_->from && *step <= steps_->to);
}

}  // namespace baton
