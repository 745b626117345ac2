#include "counterfactual.hpp"

#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <map>
#include <set>
#include <system_error>

#include "base/error.hpp"
#include "parameter_setting.hpp"
#include "recorded_run.hpp"
#include "report/recording.hpp"
#include "runtime/checkpoint.hpp"
#include "runtime/paths.hpp"
#include "runtime/recorded_messages.hpp"
#include "runtime/running_law.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

/// A law and its place in a recorded run.
struct Candidate {
  Scenario scenario;                               // the run's, with the law among its controllers
  std::size_t controller = 0;                      // which of them it is
  std::uint64_t first_step = 0;                    // of the run
  std::optional<std::vector<std::uint8_t>> state;  // that a branch gave it to begin with
  std::set<std::uint64_t> commands_once_more;      // steps
  std::set<std::uint64_t> forgets;
  bool is_itself = false;

  [[nodiscard]] const ControllerConfig& config() const { return scenario.controllers.at(controller); }
};

std::map<std::string, ParameterValue> valuesOf(const std::vector<std::string>& settings) {
  std::map<std::string, ParameterValue> values;
  for (const std::string& setting : settings) {
    const auto [name, value] = parseParameter(setting);
    if (!values.emplace(name, value).second) throw UsageError("--set: " + name + " is there twice");
  }
  return values;
}

/// One that was not in the run.
Candidate newcomer(const mcap::Source& reader, const mcap::FileList& file, const CounterfactualWish& wish) {
  Candidate candidate;
  Scenario& scenario = candidate.scenario = recordedScenario(reader, file);
  const LawInfo& law = findLaw(wish.law);
  scenario.controllers.push_back(
      {law.name, law.name, completeParameters(law.parameters, valuesOf(wish.settings), scenario.robot.size())});
  candidate.controller = scenario.controllers.size() - 1;
  // What was planned for a controller that happens to be called so is not meant for this one.
  std::erase_if(scenario.changes, [&](const PlannedChange& change) { return change.controller == law.name; });
  std::erase_if(scenario.failures, [&](const PlannedFailure& failure) { return failure.controller == law.name; });
  return candidate;
}

/// A folder that nobody else can foresee or write to, deleted with everything in it.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (fs::temp_directory_path() / "baton-whatif-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw UnavailableError("cannot make a folder like " + pattern + ": " + std::strerror(errno));
    }
    folder_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

/// What the branch's checkpoint knows of a controller; nothing when the run is no branch or knows nothing.
std::optional<std::vector<std::uint8_t>> stateAtBranch(const RecordedRun& run, const std::string& controller) {
  if (!run.checkpoint) return std::nullopt;
  const Scratch scratch;
  const fs::path file = scratch.file("checkpoint.mcap");
  writeFile(file, *run.checkpoint);
  const CheckpointSet set = readCheckpoint(file);
  const auto found = set.states.find(controller);
  return found == set.states.end() ? std::nullopt : std::optional(found->second);
}

/// When the controller had to command as the outgoing one, and when it had to begin anew as the incoming one.
void readHandovers(const mcap::Source& reader, const RecordedRun& run, Candidate& candidate) {
  std::map<std::uint64_t, msg::SwapPlan> plans;
  forEachMessageOf(dds::topics::kSwapPlan, reader, run.begin_ns, [&](const msg::SwapPlan& plan, const auto&) {
    if (plan.phase() == msg::SWAP_COMMIT) plans[plan.plan_id()] = plan;
    if (plan.phase() == msg::SWAP_CANCEL) plans.erase(plan.plan_id());
  });
  const std::string& name = candidate.config().name;
  for (const auto& [id, plan] : plans) {
    if (name == plan.outgoing().c_str()) candidate.commands_once_more.insert(plan.at_step());
    if (name == plan.incoming().c_str() && plan.hard()) candidate.forgets.insert(plan.at_step());
  }
}

/// One in the place of a controller: it lives through the same, and has the same values unless others are asked for.
Candidate standIn(const mcap::Source& reader, const mcap::FileList& file, const CounterfactualWish& wish) {
  const RecordedRun run = readRecordedRun(file);
  Candidate candidate;
  Scenario& scenario = candidate.scenario = run.scenario;
  candidate.first_step = run.first_step;
  const ControllerConfig& recorded = run.scenario.controller(wish.as);
  const auto place = std::find_if(scenario.controllers.begin(), scenario.controllers.end(),
                                  [&](const ControllerConfig& one) { return one.name == wish.as; });
  candidate.controller = static_cast<std::size_t>(std::distance(scenario.controllers.begin(), place));
  scenario.failures = failuresOf(run);
  std::ranges::copy(askedChangesOf(run), std::back_inserter(scenario.changes));
  const LawInfo& law = findLaw(wish.law.empty() ? recorded.law : wish.law);
  const bool is_same_law = law.name == recorded.law;
  const auto set = valuesOf(wish.settings);
  ParameterValues values = is_same_law ? recorded.parameters : ParameterValues{};
  for (const auto& [name, value] : set) values[name] = value;
  *place = {recorded.name, law.name, completeParameters(law.parameters, values, scenario.robot.size())};
  // Another law has other parameters, and a value that is asked for stays.
  for (PlannedChange& planned : scenario.changes) {
    if (planned.controller != wish.as) continue;
    if (!is_same_law) planned.change.set.clear();
    for (const auto& [name, value] : set) planned.change.set.erase(name);
  }
  std::erase_if(scenario.changes, [](const PlannedChange& planned) { return planned.change.set.empty(); });
  if (is_same_law) candidate.state = stateAtBranch(run, wish.as);
  candidate.is_itself = is_same_law && set.empty();
  readHandovers(reader, run, candidate);
  return candidate;
}

Candidate candidateFor(const mcap::Source& reader, const mcap::FileList& file, const CounterfactualWish& wish) {
  if (wish.law.empty() && wish.as.empty()) {
    throw UsageError("expected a law (--law), or a controller of the recording (--as), found neither");
  }
  return wish.as.empty() ? newcomer(reader, file, wish) : standIn(reader, file, wish);
}

void expectContacts(const mcap::Source& reader, const LawInfo& law, const mcap::FileList& file) {
  if (!law.uses_force || hasTopic(reader, dds::topics::kContact.name)) return;
  throw UsageError(file.string() + ": expected contact forces, which the law " + law.name +
                   " uses, found no topic contact in the recording: try a law that is blind to them (`baton laws`)");
}

/// Whether a controller of the run waits for the contact; nothing when nobody is called so.
std::optional<bool> usesForce(const Scenario& scenario, const std::string& name) {
  for (const ControllerConfig& one : scenario.controllers) {
    if (one.name == name) return findLaw(one.law).uses_force;
  }
  return std::nullopt;
}

/// Takes a law through the steps.
class Walk {
 public:
  Walk(const mcap::Source& reader, const Candidate& candidate, Counterfactual& made, const EffortSink& sink)
      : candidate_(candidate),
        made_(made),
        sink_(sink),
        law_(candidate.scenario, candidate.config(), candidate.first_step),
        effort_(JointVector::Zero(candidate.scenario.robot.size())) {
    if (!hasTopic(reader, dds::topics::kJointCommand.name)) {
      why_without_recorded_ = "the recording is without the topic joint_command";
    }
    input_.dt_s = candidate.scenario.stepSeconds();
    if (!candidate.state) return;
    StateArchive archive = StateArchive::from(std::as_bytes(std::span(*candidate.state)));
    law_.archive(archive);
    if (!archive.isWhole()) {
      throw UsageError("expected the state of " + candidate.config().name +
                       " at the branch as this build has it, found that of another build: use the one it ran with");
    }
  }

  void operator()(const RecordedStep& step) {
    if (made_.steps == 0) made_.first_step = step.step;
    const std::uint64_t expected = made_.steps == 0 ? step.step : last_ + 1;
    if (step.step > expected) made_.without_inputs.add(expected, step.step - expected);
    last_ = step.step;
    made_.run_hash = step.chain_hash;
    ++made_.steps;
    noteHolder(step);
    const std::optional<JointVector>* recorded = step.effort();
    const bool is_recorded = recorded != nullptr && recorded->has_value();
    if (!is_recorded) made_.without_recorded.add(step.step, 1, why_without_recorded_);
    if (!step.reference || (law_.info().uses_force && !step.contact)) return made_.without_inputs.add(step.step);
    if (!isAsTheHolderSawIt(step)) made_.with_other_inputs.add(step.step);
    if (!compute(step)) return;
    if (is_recorded) compare(step, **recorded);
    if (sink_) sink_(step, effort_, step.inputsHash(law_.info().uses_force));
  }

  [[nodiscard]] std::uint64_t lastStep() const { return last_; }

 private:
  void noteHolder(const RecordedStep& step) {
    if (made_.tenures.empty() || made_.tenures.back().holder != step.holder) {
      made_.tenures.push_back({step.holder, step.step, step.step, {}});
    }
    made_.tenures.back().last_step = step.step;
  }

  [[nodiscard]] bool isAsTheHolderSawIt(const RecordedStep& step) const {
    const RecordedCommand* command = step.commandOfHolder();
    const std::optional<bool> uses_force = usesForce(made_.scenario, step.holder);
    if (command == nullptr || !uses_force || (*uses_force && !step.contact)) return true;  // it is not known
    return command->inputs_hash == step.inputsHash(*uses_force);
  }

  [[nodiscard]] RunningLaw::Role roleAt(const RecordedStep& step) const {
    if (made_.wish.in_shadow) return {};
    if (made_.wish.as.empty()) return {.holds = true};
    return {.holds = step.holder == made_.wish.as,
            .commands_once_more = candidate_.commands_once_more.contains(step.step),
            .forgets = candidate_.forgets.contains(step.step)};
  }

  bool compute(const RecordedStep& step) {
    input_.state = step.state->value;
    input_.reference = step.reference->value;
    if (law_.info().uses_force) input_.contact = step.contact->value;
    law_.advance(step.step);
    const LawStatus status = law_.compute(step.step, roleAt(step), input_, effort_);
    if (status != LawStatus::kOk) made_.without_effort.add(step.step, 1, toString(status));
    return status == LawStatus::kOk;
  }

  void compare(const RecordedStep& step, const JointVector& recorded) {
    made_.tenures.back().difference.add(step.step, effort_, recorded);
    if (!made_.isOfOneController() || step.holder == made_.wish.as) made_.overall.add(step.step, effort_, recorded);
  }

  const Candidate& candidate_;
  Counterfactual& made_;
  const EffortSink& sink_;
  RunningLaw law_;
  LawInput input_;
  JointVector effort_;
  std::string why_without_recorded_;
  std::uint64_t last_ = 0;
};

}  // namespace

void Gap::add(std::uint64_t step, std::uint64_t count, const std::string& why) {
  if (steps == 0) {
    first_step = step;
    reason = why;
  }
  steps += count;
  last_step = step + count - 1;
}

void Gap::spare(std::uint64_t step) {
  if (steps > 0 && last_step == step) --steps;
}

Counterfactual counterfactual(const mcap::FileList& file, const CounterfactualWish& wish, const EffortSink& sink,
                              const std::function<void(double)>& progress) {
  const mcap::JoinedReader reader(file);
  const Candidate candidate = candidateFor(reader, file, wish);
  for (const char* topic : {dds::topics::kPlantState.name, dds::topics::kReference.name}) {
    expectTopic(reader, topic, file);
  }
  const ControllerConfig& config = candidate.config();
  expectContacts(reader, findLaw(config.law), file);
  Counterfactual made;
  made.wish = wish;
  made.scenario = recordedScenario(reader, file);
  made.law = config.law;
  made.parameters = config.parameters;
  made.changes = candidate.scenario.changesOf(config.name).size();
  made.is_itself = candidate.is_itself;
  made.has_faulty_commands = !wish.as.empty() && made.scenario.wantsFaultOf(wish.as);
  made.is_complete = isCertified(reader);
  if (reader.info().is_cut) made.cut = reader.info().problem;
  made.run = metadataValue(reader, "baton.run", "run");

  Walk walk(reader, candidate, made, sink);
  forEachStep(reader, lastTakeBegin(reader), made.scenario.robot.size(), std::ref(walk), progress);
  if (made.steps == 0) throw UsageError(file.string() + ": expected the states of a run, found none");
  for (Gap* gap : {&made.without_inputs, &made.without_recorded}) gap->spare(walk.lastStep());
  return made;
}

std::string placeOf(const CounterfactualWish& wish) {
  if (wish.in_shadow) return "standing by at every step";
  if (wish.as.empty()) return "holding the baton from the first step to the last";
  return "in the place of " + wish.as;
}

}  // namespace baton
