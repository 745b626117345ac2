#include "runtime/recorded_take.hpp"

#include <spdlog/fmt/fmt.h>

#include <map>
#include <set>
#include <string>

#include "base/error.hpp"
#include "mcap/lookup.hpp"
#include "runtime/recorded_extras.hpp"
#include "runtime/recorded_messages.hpp"

namespace baton {
namespace {

/// For a recording without the topic that announces a reset: a take begins where the steps go back.
Take lastTakeByStates(const mcap::Source& reader) {
  Take last;
  std::map<mcap::ChannelId, std::uint64_t> steps;
  forEachMessageOf(dds::topics::kPlantState, reader, 0, [&](const msg::PlantState& state, const auto& view) {
    const auto [step, is_first] = steps.try_emplace(view.channel->id, state.step());
    if (!is_first && state.step() < step->second) {
      last = {.number = last.number + 1, .begin_ns = view.log_time_ns, .resets = last.resets + 1};
    }
    step->second = state.step();
  });
  return last;
}

/// Each run has a plant of its own.
void expectOneRun(const mcap::Source& reader) {
  std::set<std::string> plants;
  const auto& counts = reader.statistics().channel_message_counts;
  for (const auto& [id, channel] : reader.channels()) {
    const auto count = counts.find(id);
    if (channel.topic != dds::topics::kPlantState.name || count == counts.end() || count->second == 0) continue;
    plants.insert(mcap::valueOf(channel.metadata, "writer"));
  }
  if (plants.size() < 2) return;
  throw UsageError(
      fmt::format("expected a recording of one run, found the states of {} plants in it (writers {}): give the files "
                  "of one run, or take its time out with `baton bag cut --from T --to T`",
                  plants.size(), fmt::join(plants, ", ")));
}

Take findLastTake(const mcap::Source& reader) {
  const char* topic = dds::topics::kRewind.name;
  if (!hasTopic(reader, topic) && (isLeftOut(reader, topic) || !hasCertificate(reader))) {
    return lastTakeByStates(reader);
  }
  Take last;
  forEachMessageOf(dds::topics::kRewind, reader, 0, [&](const msg::Rewind& rewind, const auto& view) {
    if (rewind.phase() != msg::REWIND_COMMIT || view.log_time_ns < last.begin_ns) return;
    last = {.number = rewind.take(), .begin_ns = view.log_time_ns, .resets = last.resets + 1};
  });
  return last;
}

}  // namespace

std::uint64_t lastTakeBegin(const mcap::Source& reader) { return lastTake(reader).begin_ns; }

Take lastTake(const mcap::Source& reader) {
  expectOneRun(reader);
  return findLastTake(reader);
}

std::uint32_t resetsIn(const mcap::Source& reader) { return findLastTake(reader).resets; }

}  // namespace baton
