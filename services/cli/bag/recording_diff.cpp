#include "bag/recording_diff.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <set>
#include <tuple>
#include <utility>

#include "bag/selection.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "control/nearest_name.hpp"
#include "dds/topics.hpp"
#include "mcap/lookup.hpp"
#include "runtime/recorded_take.hpp"
#include "runtime/recorded_types.hpp"

namespace baton {
namespace {

constexpr std::uint64_t kShowEvery = 4096;

/// A sample whose counterpart has not come yet.
struct Waiting {
  Position at;
  std::uint64_t log_time_ns;
  const schema::Type* type;
  mcap::Bytes bytes;
};

struct Stream {
  StreamDiff result;
  std::array<bool, 2> is_there{};  // in A, in B
  std::array<Position, 2> last{};  // position of the last sample
  std::array<bool, 2> has_begun{};
  std::deque<Waiting> waiting;  // all of one side
  std::size_t side = 0;         // theirs
};

/// One of the two files.
struct Side {
  explicit Side(const mcap::FileList& file, std::vector<std::string>& warnings)
      : reader(file),
        types([&, name = file.string()](const std::string& problem) { warnings.push_back(name + ": " + problem); }) {
    const std::string problem = mcap::incompletenessOf(reader.info());
    if (!problem.empty()) warnings.push_back(file.string() + ": " + problem);
    for (const std::string& text : reader.info().contradictions) warnings.push_back(file.string() + ": " + text);
  }
  [[nodiscard]] const mcap::Schema* schemaOf(const mcap::Channel& channel) const {
    const auto found = reader.schemas().find(channel.schema_id);
    return found == reader.schemas().end() ? nullptr : &found->second;
  }

  mcap::JoinedReader reader;
  RecordedTypes types;
  std::map<mcap::ChannelId, Stream*> streams;  // those compared
  std::map<mcap::ChannelId, FieldRules> rules;
  std::optional<mcap::JoinedCursor> messages;
  bool is_over = false;
  std::size_t waiting_bytes = 0;
};

/// What two runs of a scenario have in common.
constexpr std::array kLoopTopics{dds::topics::kPlantState.name, dds::topics::kContact.name,
                                 dds::topics::kReference.name, dds::topics::kJointCommand.name,
                                 dds::topics::kShadowCommand.name};

bool isOfTheLoop(const std::string& topic) { return std::ranges::count(kLoopTopics, topic) > 0; }

class Differ {
 public:
  explicit Differ(const DiffRequest& request)
      : request_(request),
        rules_(request.ignored, request.tolerances),
        sides_{Side(request.a, diff_.warnings), Side(request.b, diff_.warnings)} {
    choose();
  }

  RecordingDiff run(const std::function<void(double)>& progress) {
    const double expected = static_cast<double>(sides_[0].reader.statistics().message_count) +
                            static_cast<double>(sides_[1].reader.statistics().message_count);
    std::uint64_t done = 0;
    while (!sides_[0].is_over || !sides_[1].is_over) {
      const std::size_t side = sides_[0].is_over                                    ? 1
                               : sides_[1].is_over                                  ? 0
                               : sides_[0].waiting_bytes <= sides_[1].waiting_bytes ? 0
                                                                                    : 1;
      if (++done % kShowEvery == 0) progress(std::min(1.0, static_cast<double>(done) / std::max(1.0, expected)));
      advance(side);
    }
    for (auto& [key, stream] : streams_) {
      while (!stream.waiting.empty()) dropWaiting(stream);
      diff_.streams[key] = std::move(stream.result);
    }
    for (std::size_t side = 0; side < 2; ++side) {
      if ((request_.from_step == 0 && !request_.to_step) || diff_.first_step[side]) continue;
      throw UsageError("--from-step, --to-step: expected steps of both recordings, found none in " +
                       (side == 0 ? request_.a : request_.b).string());
    }
    return std::move(diff_);
  }

 private:
  /// Which topics are compared, with which rules.
  void choose() {
    std::set<std::string> all;
    for (const Side& side : sides_) {
      for (const std::string& topic : mcap::topicNames(side.reader)) all.insert(topic);
    }
    const std::vector<std::string> names(all.begin(), all.end());
    for (const std::string& topic : names) rules_.meetTopic(topic);
    for (const std::string& topic : request_.topics) {
      if (!all.contains(topic)) throw UsageError(escaped(unknownName("topic", topic, names)));
    }
    const bool has_loop = std::ranges::any_of(names, isOfTheLoop);
    const auto isCompared = [&](const std::string& topic) {
      if (rules_.ignoresTopic(topic)) return false;
      if (!request_.topics.empty()) return std::ranges::count(request_.topics, topic) > 0;
      return has_loop ? isOfTheLoop(topic) : !dds::isStatusTopic(topic);
    };
    for (std::size_t side = 0; side < 2; ++side) {
      const Take take = request_.all_takes ? Take{} : lastTake(sides_[side].reader);
      diff_.resets_before[side] = take.resets;
      openStreams(side, isCompared, take.begin_ns);
    }
    if (streams_.empty()) throw UsageError("expected topics to compare, found none; --topics chooses them");
    for (const std::string& name : names) {
      if (!isCompared(name)) diff_.left_out.push_back(name);
    }
    if (const std::vector<std::string> unmet = rules_.unmet(); !unmet.empty()) {
      throw UsageError("expected a topic or field that is compared, found '" + unmet.front() + "'" +
                       didYouMean(unmet.front(), names));
    }
  }

  template <class IsCompared>
  void openStreams(std::size_t side, const IsCompared& is_compared, std::uint64_t begin_ns) {
    Side& file = sides_[side];
    mcap::MessageFilter filter{.start_time_ns = begin_ns};
    for (const auto& [id, channel] : file.reader.channels()) {
      if (!is_compared(channel.topic)) continue;
      Stream& stream = streams_[{channel.topic, serviceOf(channel)}];
      stream.is_there[side] = true;
      file.streams[id] = &stream;
      file.rules[id] = rules_.rulesFor(channel.topic, file.types.typeOf(channel, file.schemaOf(channel)));
      filter.channels.push_back(id);
    }
    file.is_over = filter.channels.empty();  // an empty filter would be all
    file.messages.emplace(file.reader.messages(filter));
  }

  static Position next(Stream& stream, std::size_t side, const std::optional<std::uint64_t>& step) {
    Position& last = stream.last[side];
    const bool is_first = !std::exchange(stream.has_begun[side], true);
    if (is_first) {
      last = {.step = step};
    } else if (!step || step == last.step) {
      ++last.index;
    } else {
      last = {.take = last.take + (step < last.step ? 1 : 0), .step = step};
    }
    return last;
  }

  void advance(std::size_t side) {
    Side& file = sides_[side];
    mcap::MessageView message;
    if (!file.messages->next(message)) {
      file.is_over = true;
      return;
    }
    Stream& stream = *file.streams.at(message.channel->id);
    const TypedPayload payload{file.types.typeOf(message), message.data};
    const Position at = next(stream, side, stepOf(payload));
    if (at.step && (*at.step < request_.from_step || *at.step > request_.to_step.value_or(UINT64_MAX))) return;
    if (at.step) diff_.first_step[side] = std::min(*at.step, diff_.first_step[side].value_or(*at.step));
    const std::size_t other = 1 - side;
    if (!stream.waiting.empty() && stream.side == other) {
      while (!stream.waiting.empty() && stream.waiting.front().at < at) dropWaiting(stream);
      if (!stream.waiting.empty()) {
        if (stream.waiting.front().at == at) {
          pair(stream, side, payload, message);
        } else {
          missing(stream, side, at, message.log_time_ns);
        }
        return;
      }
    }
    if (!stream.is_there[other] || sides_[other].is_over) return missing(stream, side, at, message.log_time_ns);
    stream.side = side;
    stream.waiting.push_back(
        {at, message.log_time_ns, payload.type, mcap::Bytes(message.data.begin(), message.data.end())});
    file.waiting_bytes += message.data.size();
  }

  void pair(Stream& stream, std::size_t side, const TypedPayload& payload, const mcap::MessageView& message) {
    const Waiting& waiting = stream.waiting.front();
    const TypedPayload earlier{waiting.type, waiting.bytes};
    ++stream.result.compared;
    const FieldRules& rules = sides_[side].rules.at(message.channel->id);
    if (auto found = side == 1 ? compare(earlier, payload, rules) : compare(payload, earlier, rules)) {
      ++stream.result.different;
      tell(stream, waiting.at, side == 1 ? waiting.log_time_ns : message.log_time_ns, std::move(*found));
    }
    takeWaiting(stream);
  }

  /// Only the side has it.
  static void missing(Stream& stream, std::size_t side, const Position& at, std::uint64_t log_time_ns) {
    ++(side == 0 ? stream.result.only_a : stream.result.only_b);
    tell(stream, at, log_time_ns, {"", side == 0 ? "a message" : "none", side == 0 ? "none" : "a message"});
  }

  void dropWaiting(Stream& stream) {
    missing(stream, stream.side, stream.waiting.front().at, stream.waiting.front().log_time_ns);
    takeWaiting(stream);
  }

  void takeWaiting(Stream& stream) {
    sides_[stream.side].waiting_bytes -= stream.waiting.front().bytes.size();
    stream.waiting.pop_front();
  }

  static void tell(Stream& stream, const Position& at, std::uint64_t log_time_ns, FieldDifference what) {
    if (stream.result.first && stream.result.first->at <= at) return;
    stream.result.first = {at, log_time_ns, std::move(what)};
  }

  const DiffRequest& request_;  // of the caller, who waits for run()
  RecordingDiff diff_;
  RuleSet rules_;
  std::array<Side, 2> sides_;
  std::map<StreamKey, Stream> streams_;
};

}  // namespace

bool RecordingDiff::isSame() const {
  return std::ranges::all_of(streams, [](const auto& entry) { return entry.second.isSame(); });
}

std::optional<std::uint64_t> RecordingDiff::laterBegin() const {
  const auto& [a, b] = first_step;
  return a && b && a != b ? std::optional(std::max(*a, *b)) : std::nullopt;
}

std::optional<StreamKey> RecordingDiff::firstDifferent() const {
  const StreamKey* earliest = nullptr;
  const FirstDifference* first = nullptr;
  const auto place = [](const FirstDifference& one) {
    // What has no step stands behind what has one.
    return std::tuple(!one.at.step, one.at.take, one.at.step, one.log_time_ns);
  };
  for (const auto& [key, stream] : streams) {
    if (!stream.first || (first != nullptr && place(*first) <= place(*stream.first))) continue;
    earliest = &key;
    first = &*stream.first;
  }
  return earliest == nullptr ? std::nullopt : std::optional(*earliest);
}

RecordingDiff diffRecordings(const DiffRequest& request, const std::function<void(double)>& progress) {
  return Differ(request).run(progress);
}

}  // namespace baton
