#include "recorded_run.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

#include "base/error.hpp"
#include "messages/parameters.hpp"
#include "report/recording.hpp"
#include "runtime/recorded_messages.hpp"
#include "runtime/scenario_edit.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

std::string listText(const std::vector<std::string>& entries) { return fmt::format("[{}]", fmt::join(entries, ", ")); }

/// All of the repetition, in one file, whatever was wanted of the original.
std::string wholeRecording(const Scenario& scenario) {
  return "{checkpoint_s: " + secondsText(scenario.recording.checkpoint_steps, scenario) + "}";
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

std::string yamlOf(const ParameterValue& value) {
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  return fmt::format("[{:.17g}]", fmt::join(std::get<std::vector<double>>(value), ", "));
}

std::string yamlOf(const PlannedChange& change, const Scenario& scenario) {
  std::vector<std::string> values;
  for (const auto& [name, value] : change.change.set) values.push_back(name + ": " + yamlOf(value));
  return fmt::format("{{at_s: {}, controller: {}, set: {{{}}}}}", secondsText(change.change.at_step, scenario),
                     change.controller, fmt::join(values, ", "));
}

/// A process that is started again knows of the scenario's values only: what an operator has changed for the one before
/// it, in force or still to come, is taken back.
PlannedChange takenBack(const PlannedChange& asked, std::uint64_t restart_step, const Scenario& scenario) {
  PlannedChange back{.controller = asked.controller, .change = asked.change};
  back.change.at_step = std::max(asked.change.at_step, restart_step);
  ParameterValues planned = scenario.controller(asked.controller).parameters;
  for (const ParameterChange& change : scenario.changesOf(asked.controller)) {
    if (change.at_step > back.change.at_step) break;
    for (const auto& [name, value] : change.set) planned[name] = value;
  }
  for (auto& [name, value] : back.change.set) value = planned.at(name);
  return back;
}

/// Whether the scenario only plans it: then no process was started again.
bool isPlannedReturn(const msg::Decision& decision, const Scenario& scenario) {
  return std::any_of(scenario.failures.begin(), scenario.failures.end(), [&](const PlannedFailure& failure) {
    return failure.controller == decision.controller().c_str() && failure.returns_at_step == decision.step();
  });
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

/// Whether what a controller computes has mattered before that log time: it held the baton, or was asked to take it.
bool matteredBefore(const mcap::Source& reader, const std::string& name, std::uint64_t log_time_ns) {
  bool has_mattered = false;
  forEachMessageOf(dds::topics::kPlantState, reader, 0, [&](const msg::PlantState& state, const auto& view) {
    has_mattered = has_mattered || (view.log_time_ns < log_time_ns && state.holder() == name);
  });
  forEachMessageOf(dds::topics::kSwapPlan, reader, 0, [&](const msg::SwapPlan& plan, const auto& view) {
    const bool is_handover = plan.phase() != msg::SWAP_FORECAST;
    has_mattered = has_mattered || (view.log_time_ns < log_time_ns && is_handover && plan.incoming() == name);
  });
  return has_mattered;
}

/// Log times at which controllers were given another law or other values to begin with, by name: the last ones.
using Relaunches = std::map<std::string, std::uint64_t>;

/// The scenario with the controllers that were started while the run went on, from its first step: as long as they
/// stand by, nobody feels them.
std::string withLaunches(const mcap::Source& reader, std::string text, const mcap::FileList& file,
                         Relaunches& relaunches) {
  std::map<std::uint64_t, msg::LaunchRequest> requests;
  forEachMessageOf(dds::topics::kLaunchRequest, reader, 0,
                   [&](const msg::LaunchRequest& request, const auto&) { requests[request.request_id()] = request; });
  forEachMessageOf(dds::topics::kLaunchReply, reader, 0, [&](const msg::LaunchReply& reply, const auto& view) {
    if (!reply.accepted() || !requests.contains(reply.request_id())) return;
    const msg::LaunchRequest& request = requests.at(reply.request_id());
    const std::string name = request.name().c_str();
    if (request.action() != msg::LAUNCH_START) return;
    const bool is_changed = request.law().size() > 0 || request.parameters().size() > 0;
    if (is_changed && matteredBefore(reader, name, view.log_time_ns)) {
      throw UsageError(file.string() + ": " + name + " was given another law or other values after it had held the " +
                       "baton or had been asked to take it, and a scenario has one of each for a name");
    }
    if (is_changed) relaunches[name] = view.log_time_ns;
    text = withController(text, name, request.law().c_str(), request.parameters().c_str());
  });
  return text;
}

}  // namespace

RecordedRun readRecordedRun(const mcap::FileList& file) {
  const mcap::JoinedReader reader(file);
  const Take take = lastTake(reader);
  Relaunches relaunches;
  RecordedRun run{
      .file = file,
      .scenario_text = withLaunches(reader, neededAttachment(reader, "scenario.yaml", file), file, relaunches),
      .robot_text = neededAttachment(reader, "robot.yaml", file),
      .checkpoint = attachmentText(reader, "checkpoint.mcap"),
      .scenario = {},
      .begin_ns = take.begin_ns,
      .checkpoints_from_ns = take.begin_ns,
      .first_step = 0,
      .last_step = 0,
      .decisions = {}};
  expectTopic(reader, dds::topics::kPlantState.name, file);
  for (const char* topic : {dds::topics::kDecision.name, dds::topics::kSwapPlan.name, dds::topics::kRewind.name}) {
    expectNotLeftOut(reader, topic, file);
  }
  run.scenario =
      parseScenario(file.string() + "#scenario.yaml", run.scenario_text, file.string() + "#robot.yaml", run.robot_text);
  bool has_states = false;
  forEachMessageOf(dds::topics::kPlantState, reader, take.begin_ns, [&](const msg::PlantState& state, const auto&) {
    run.first_step = has_states ? std::min(run.first_step, state.step()) : state.step();
    run.last_step = std::max(run.last_step, state.step());
    has_states = true;
  });
  if (!has_states) throw UsageError(file.string() + ": expected the states of a run, found none");
  // By their take, not by when they came: what is decided at its first step may be recorded before its begin.
  forEachMessageOf(dds::topics::kDecision, reader, 0,
                   [&](const msg::Decision& decision, const mcap::MessageView& view) {
                     if (decision.take() != take.number) return;
                     const auto relaunched = relaunches.find(decision.controller().c_str());
                     // What was changed in a law that is not in the scenario any more was felt by nobody.
                     const bool is_gone = decision.cause() == msg::DECISION_PARAMETERS &&
                                          relaunched != relaunches.end() && view.log_time_ns < relaunched->second;
                     if (!is_gone) run.decisions.push_back(decision);
                   });
  for (const auto& [name, log_time_ns] : relaunches) {
    run.checkpoints_from_ns = std::max(run.checkpoints_from_ns, log_time_ns);
  }
  return run;
}

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

std::vector<PlannedChange> askedChangesOf(const RecordedRun& run) {
  std::vector<PlannedChange> changes;
  std::map<std::string, std::vector<PlannedChange>> asked;  // of the process that now is the controller
  for (const msg::Decision& decision : run.decisions) {
    const std::string controller = decision.controller().c_str();
    if (decision.cause() == msg::DECISION_PARAMETERS) {
      changes.push_back(
          {.controller = controller,
           .change = {.at_step = decision.at_step(), .set = fromMessages(decision.values()), .is_planned = true}});
      asked[controller].push_back(changes.back());
    } else if (decision.cause() == msg::DECISION_RETURNED && decision.restarted() &&
               !isPlannedReturn(decision, run.scenario)) {
      for (const PlannedChange& one : asked[controller]) {
        changes.push_back(takenBack(one, decision.step(), run.scenario));
      }
      asked[controller].clear();
    }
  }
  return changes;
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
                                                            {"recording", wholeRecording(run.scenario)},
                                                            {"swaps", swapsText(swaps, run.scenario)},
                                                            {"failures", failuresText(run)},
                                                            {"stops", stopsText(run)}});
  // A message that is lost or a process that is struck changes no byte but by what was decided about it; numbers do.
  const std::vector<Fault>& faults = run.scenario.faults;
  const std::string spared =
      keepInScenario(text, "faults", [&](std::size_t index) { return isOfValues(faults.at(index).kind); });
  std::vector<std::string> changes;
  for (const PlannedChange& change : askedChangesOf(run)) changes.push_back(yamlOf(change, run.scenario));
  return appendToScenario(spared, "changes", changes);
}

}  // namespace baton
