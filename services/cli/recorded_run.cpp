#include "recorded_run.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "base/error.hpp"
#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/reader.hpp"
#include "report/recording.hpp"
#include "runtime/scenario_edit.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

std::string needed(const mcap::Reader& reader, const std::string& name, const fs::path& file) {
  if (auto text = attachmentText(reader, name)) return *text;
  throw UsageError(file.string() + ": expected the recording of a run, with its " + name + ", found none");
}

template <class T, class F>
void forEach(const mcap::Reader& reader, std::uint64_t begin_ns, const dds::Topic<T>& topic, const F& f) {
  T message;
  reader.forEachMessage({.topics = {topic.name}, .start_time_ns = begin_ns, .order = mcap::MessageFilter::Order::kFile},
                        [&](const mcap::MessageView& view) {
                          if (dds::decode(view.data, message)) f(message);
                        });
}

std::string listText(const std::vector<std::string>& entries) { return fmt::format("[{}]", fmt::join(entries, ", ")); }

/// Who failed when, and came back when.
std::vector<PlannedFailure> failuresOf(const RecordedRun& run) {
  std::vector<PlannedFailure> failures;
  for (const msg::Decision& decision : run.decisions) {
    const std::string controller = decision.controller().c_str();
    if (decision.cause() == msg::DECISION_FAILED) {
      PlannedFailure failure{.at_step = {},
                             .controller = controller,
                             .commanded = decision.commanded(),
                             .returns_at_step = {},
                             .restarted = false};
      if (decision.at_step() > decision.step()) failure.at_step = decision.step();
      failures.push_back(failure);
    } else if (decision.cause() == msg::DECISION_RETURNED) {
      const auto open = std::find_if(failures.rbegin(), failures.rend(),
                                     [&](const PlannedFailure& failure) { return failure.controller == controller; });
      if (open == failures.rend()) continue;
      open->returns_at_step = decision.step();
      open->restarted = decision.restarted();
    }
  }
  return failures;
}

std::string failuresText(const RecordedRun& run) {
  std::vector<std::string> entries;
  for (const PlannedFailure& failure : failuresOf(run)) {
    std::string text = "{controller: " + failure.controller;
    if (failure.at_step) {
      text += fmt::format(", at_s: {}, commanded: {}", secondsText(*failure.at_step, run.scenario), failure.commanded);
    }
    if (failure.returns_at_step) {
      text += fmt::format(", returns_at_s: {}, restarted: {}", secondsText(*failure.returns_at_step, run.scenario),
                          failure.restarted);
    }
    entries.push_back(text + "}");
  }
  return listText(entries);
}

std::string stopsText(const RecordedRun& run) {
  std::vector<std::string> entries;
  for (const msg::Decision& decision : run.decisions) {
    // One that took effect at once is where the recording ends.
    if (decision.cause() != msg::DECISION_END || decision.at_step() == decision.step()) continue;
    entries.push_back(fmt::format("{{decided_at_s: {}, at_s: {}}}", secondsText(decision.step(), run.scenario),
                                  secondsText(decision.at_step(), run.scenario)));
  }
  return listText(entries);
}

std::vector<std::string> changeEntries(const RecordedRun& run) {
  std::vector<std::string> entries;
  for (const msg::Decision& decision : run.decisions) {
    if (decision.cause() != msg::DECISION_PARAMETERS) continue;
    std::vector<std::string> values;
    for (const msg::ParameterValue& value : decision.values()) {
      const std::string shown = value.numbers().empty() ? std::string(value.word().c_str())
                                                        : fmt::format("[{:.17g}]", fmt::join(value.numbers(), ", "));
      values.push_back(fmt::format("{}: {}", value.name().c_str(), shown));
    }
    entries.push_back(fmt::format("{{at_s: {}, controller: {}, set: {{{}}}}}",
                                  secondsText(decision.at_step(), run.scenario), decision.controller().c_str(),
                                  fmt::join(values, ", ")));
  }
  return entries;
}

/// What came to nothing in the very step it was decided in leaves no trace.
bool cameToNothing(const std::vector<msg::Decision>& decisions, std::size_t index) {
  const msg::Decision& swap = decisions[index];
  return std::any_of(decisions.begin() + static_cast<std::ptrdiff_t>(index), decisions.end(),
                     [&](const msg::Decision& later) {
                       return later.cause() == msg::DECISION_FAILED && later.step() == swap.step() &&
                              later.controller() == swap.controller();
                     });
}

/// Whether a controller held the baton before that log time.
bool heldBefore(const mcap::Reader& reader, const std::string& name, std::uint64_t log_time_ns) {
  bool has_held = false;
  msg::PlantState state;
  reader.forEachMessage({.topics = {dds::topics::kPlantState.name}}, [&](const mcap::MessageView& view) {
    has_held = has_held || (view.log_time_ns < log_time_ns && dds::decode(view.data, state) && state.holder() == name);
  });
  return has_held;
}

/// The scenario with the controllers that were started while the run went on, from its first step: as long as they
/// stand by, nobody feels them.
std::string withLaunches(const mcap::Reader& reader, std::string text, const fs::path& file) {
  std::map<std::uint64_t, msg::LaunchRequest> requests;
  forEach(reader, 0, dds::topics::kLaunchRequest,
          [&](const msg::LaunchRequest& request) { requests[request.request_id()] = request; });
  msg::LaunchReply reply;
  reader.forEachMessage({.topics = {dds::topics::kLaunchReply.name}}, [&](const mcap::MessageView& view) {
    if (!dds::decode(view.data, reply) || !reply.accepted() || !requests.contains(reply.request_id())) return;
    const msg::LaunchRequest& request = requests.at(reply.request_id());
    const std::string name = request.name().c_str();
    if (request.action() != msg::LAUNCH_START) return;
    const bool is_changed = request.law().size() > 0 || request.parameters().size() > 0;
    if (is_changed && heldBefore(reader, name, view.log_time_ns)) {
      throw UsageError(file.string() + ": " + name +
                       " was given another law after it had held the baton, and a scenario has one for each name");
    }
    text = withController(text, name, request.law().c_str(), request.parameters().c_str());
  });
  return text;
}

}  // namespace

RecordedRun readRecordedRun(const fs::path& file) {
  const mcap::Reader reader(file);
  const Take take = lastTake(reader);
  RecordedRun run{.file = file,
                  .scenario_text = withLaunches(reader, needed(reader, "scenario.yaml", file), file),
                  .robot_text = needed(reader, "robot.yaml", file),
                  .checkpoint = attachmentText(reader, "checkpoint.mcap"),
                  .scenario = {},
                  .begin_ns = take.begin_ns,
                  .first_step = 0,
                  .last_step = 0,
                  .decisions = {}};
  run.scenario =
      parseScenario(file.string() + "#scenario.yaml", run.scenario_text, file.string() + "#robot.yaml", run.robot_text);
  bool has_states = false;
  forEach(reader, take.begin_ns, dds::topics::kPlantState, [&](const msg::PlantState& state) {
    run.first_step = has_states ? std::min(run.first_step, state.step()) : state.step();
    run.last_step = std::max(run.last_step, state.step());
    has_states = true;
  });
  if (!has_states) throw UsageError(file.string() + ": expected the states of a run, found none");
  // By their take, not by when they came: what is decided at its first step may be recorded before its begin.
  forEach(reader, 0, dds::topics::kDecision, [&](const msg::Decision& decision) {
    if (decision.take() == take.number) run.decisions.push_back(decision);
  });
  return run;
}

std::vector<PlannedSwap> swapsOf(const RecordedRun& run) {
  std::vector<PlannedSwap> swaps = run.scenario.swaps;
  for (std::size_t i = 0; i < run.decisions.size(); ++i) {
    const msg::Decision& decision = run.decisions[i];
    if (decision.cause() != msg::DECISION_SWAP || cameToNothing(run.decisions, i)) continue;
    PlannedSwap swap{.at_step = decision.at_step(),
                     .to = decision.controller().c_str(),
                     .force = decision.force(),
                     .hard = decision.hard(),
                     .blend_steps = {}};
    if (!swap.hard) swap.blend_steps = decision.blend_steps();
    swaps.push_back(swap);
  }
  // In the plant the scenario's come first where two are for the same step.
  std::stable_sort(swaps.begin(), swaps.end(),
                   [](const PlannedSwap& a, const PlannedSwap& b) { return a.at_step < b.at_step; });
  return swaps;
}

std::string secondsText(std::uint64_t step, const Scenario& scenario) {
  constexpr std::uint64_t kSecond_ns = 1'000'000'000;
  const std::uint64_t ns = step * static_cast<std::uint64_t>(scenario.step_ns);
  return fmt::format("{}.{:09}", ns / kSecond_ns, ns % kSecond_ns);
}

std::string swapsText(const std::vector<PlannedSwap>& swaps, const Scenario& scenario) {
  std::vector<std::string> entries;
  for (const PlannedSwap& swap : swaps) {
    std::string text = fmt::format("{{at_s: {}, to: {}", secondsText(swap.at_step, scenario), swap.to);
    if (swap.force) text += ", force: true";
    if (swap.hard) text += ", hard: true";
    if (swap.blend_steps) text += ", blend_s: " + secondsText(*swap.blend_steps, scenario);
    if (swap.expect == SwapExpectation::kRefused) text += ", expect: refused";
    if (swap.expect == SwapExpectation::kAny) text += ", expect: any";
    entries.push_back(text + "}");
  }
  return listText(entries);
}

std::string repeatingScenario(const RecordedRun& run, std::uint64_t end_step) {
  std::vector<PlannedSwap> swaps = swapsOf(run);
  std::erase_if(swaps, [&](const PlannedSwap& swap) { return swap.at_step >= end_step; });
  // What was refused then is refused again.
  for (PlannedSwap& swap : swaps) swap.expect = SwapExpectation::kAny;
  const std::string text = editScenario(run.scenario_text, {{"robot", "./robot.yaml"},
                                                            {"duration_s", secondsText(end_step, run.scenario)},
                                                            {"rate", "max"},
                                                            {"late", "{policy: wait}"},
                                                            {"swaps", swapsText(swaps, run.scenario)},
                                                            {"failures", failuresText(run)},
                                                            {"stops", stopsText(run)}});
  // A message that is lost or a process that is struck changes no byte but by what was decided about it; numbers do.
  const std::vector<Fault>& faults = run.scenario.faults;
  const std::string spared =
      keepInScenario(text, "faults", [&](std::size_t index) { return isOfValues(faults.at(index).kind); });
  return appendToScenario(spared, "changes", changeEntries(run));
}

void writeText(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw UnavailableError("cannot write " + file.string() + ": expected space and the right to write there");
}

}  // namespace baton
