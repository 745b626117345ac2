#include "branch_command.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "cell_target.hpp"
#include "recorded_run.hpp"
#include "report/recording.hpp"
#include "run_commands.hpp"
#include "run_session.hpp"
#include "runtime/build_id.hpp"
#include "runtime/checkpoint.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/recorded_messages.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"
#include "runtime/scenario_edit.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

struct BranchRequest {
  RecordingWish recording;
  mcap::FileList files;  // found
  std::optional<std::uint64_t> at_step;
  std::optional<double> at_s;
  std::string swap;
  std::vector<std::string> set;
  RunRequest run;
  bool json = false;
};

/// Where a branch leaves its run.
struct Fork {
  RecordedRun run;
  msg::PlantState state;  // at the step of the branch
};

std::uint64_t stepOf(const BranchRequest& request, const Scenario& scenario) {
  if (request.at_step) return *request.at_step;
  if (!request.at_s) throw UsageError("branch: expected --at STEP or --at-time SECONDS");
  return static_cast<std::uint64_t>(std::round(*request.at_s / scenario.stepSeconds()));
}

Fork read(const BranchRequest& request) {
  Fork fork{.run = readRecordedRun(request.files), .state = {}};
  const std::uint64_t step = stepOf(request, fork.run.scenario);
  bool found = false;
  const mcap::JoinedReader reader(request.files);
  forEachMessageOf(dds::topics::kPlantState, reader, fork.run.begin_ns, [&](const msg::PlantState& state, const auto&) {
    if (state.step() != step) return;
    fork.state = state;
    found = true;
  });
  if (!found || step >= fork.run.last_step) {
    throw UsageError(request.files.string() + ": expected a step before its last, " +
                     std::to_string(fork.run.last_step) + ", found " + std::to_string(step));
  }
  return fork;
}

/// Runs what is in `folder` from `set` on, and throws when it does not end well.
nlohmann::ordered_json runFrom(const CheckpointSet& set, const fs::path& folder, const std::string& scenario_text,
                               const RecordedRun& original, RunRequest request, ExitCode& exit_code) {
  writeFile(folder / "robot.yaml", original.robot_text);
  writeFile(folder / "scenario.yaml", editScenario(scenario_text, {{"robot", "./robot.yaml"}}));
  if (!set.states.empty()) {
    const fs::path checkpoint = folder / ("checkpoint-" + std::to_string(set.step) + ".mcap");
    fs::remove(checkpoint);
    writeCheckpoint(checkpoint, set, original.scenario.step_ns);
    request.checkpoint = checkpoint.string();
  }
  request.scenario = (folder / "scenario.yaml").string();
  if (loadScenario(request.scenario).end_step == 0) {
    say(stderr,
        "baton: the scenario has no end, so the branch goes on until Ctrl-C or `baton down`; "
        "--set duration_s=S gives it one\n");
  }
  RunSession session(request, true);
  exit_code = runToTheEnd(session);
  if (session.wasInterrupted()) exit_code = ExitCode::kInterrupted;  // whatever had failed before
  return session.result();
}

/// The checkpoint of exactly that step. When the recording has only an earlier one, the run is repeated from there.
CheckpointSet checkpointAt(const Fork& fork, const fs::path& folder, const RunRequest& request) {
  const RecordedRun& original = fork.run;
  const std::uint64_t step = fork.state.step();
  std::vector<std::string> services = controllerNames(original.scenario);
  services.emplace_back(kPlantName);
  const mcap::JoinedReader reader(original.file);
  const bool is_ours = metadataValue(reader, "baton.run", "build_id") == buildId();
  CheckpointSet newest =
      is_ours ? newestCheckpoint(original.file, original.checkpoints_from_ns, step, services) : CheckpointSet{};
  if (newest.step == step) return newest;

  say(stderr, "repeating steps %llu to %llu\n", static_cast<unsigned long long>(newest.step),
      static_cast<unsigned long long>(step));
  RunRequest lead_in = request;
  lead_in.out = (folder / "lead_in.mcap").string();
  lead_in.overwrite = true;
  ExitCode code = ExitCode::kOk;
  const nlohmann::ordered_json result =
      runFrom(newest, folder, repeatingScenario(original, step), original, lead_in, code);
  const bool is_same = result.at("chain_hash") == std::to_string(fork.state.chain_hash());
  if (code == ExitCode::kInterrupted) throw Error(code, "interrupted while the steps before the branch were repeated");
  // A controller that was lost then is lost again, which is no success of a run.
  if (result.at("state") != "finished") {
    throw Error(code, "the steps before the branch could not be repeated: " + result.at("reason").get<std::string>());
  }
  if (!is_same) {
    throw Error(ExitCode::kFailed, "steps " + std::to_string(newest.step) + " to " + std::to_string(step) +
                                       " do not repeat: " + original.file.string() +
                                       " was recorded by another build, or is damaged; `baton rerun` tells where");
  }
  CheckpointSet made = newestCheckpoint(lead_in.out, 0, step, services);
  if (made.step != step) {
    throw UsageError("step " + std::to_string(step) +
                     " lies in a handover or where a message is stuck: choose one before or after it");
  }
  return made;
}

void expectNoPlan(std::uint64_t step, const RecordedRun& run) {
  const std::uint64_t margin = run.scenario.baton.margin_steps;
  for (const PlannedSwap& swap : swapsOf(run)) {
    if (step >= swap.at_step - margin - 1 && step < swap.at_step + 1 && step + margin + 1 != swap.at_step) {
      throw UsageError("step " + std::to_string(step) + " lies in the handover to " + swap.to + " at step " +
                       std::to_string(swap.at_step) + ": choose one up to " +
                       std::to_string(swap.at_step - margin - 1) + " or from " + std::to_string(swap.at_step + 1));
    }
  }
}

void branch(const BranchRequest& request, ExitCode& exit_code) {
  const Fork fork = read(request);
  const RecordedRun& original = fork.run;
  const std::uint64_t step = fork.state.step();
  const Scenario& scenario = original.scenario;
  expectNoPlan(step, original);
  const std::uint64_t earliest = step + scenario.baton.margin_steps + 1;
  std::vector<ScenarioSetting> settings;
  std::vector<PlannedSwap> swaps = scenario.swaps;
  std::erase_if(swaps, [&](const PlannedSwap& swap) { return swap.at_step < earliest; });
  if (!request.swap.empty()) {
    (void)scenario.controller(request.swap);
    swaps.insert(swaps.begin(), PlannedSwap{.at_step = earliest, .to = request.swap, .blend_steps = {}});
  }
  settings.emplace_back("swaps", swapsText(swaps, scenario));
  if (fork.state.holder().size() > 0) settings.emplace_back("active", fork.state.holder().c_str());
  for (const std::string& text : request.set) {
    settings.push_back(parseSetting(text));
    const std::string& path = settings.back().first;
    if (path == "step_s" || path == "robot" || path == "active") {
      throw UsageError("--set " + path + ": a branch goes on with the step, the robot and the holder of the run" +
                       (path == "active" ? "; --swap hands over" : ""));
    }
  }
  const std::string text = editScenario(original.scenario_text, settings);
  const Scenario changed = parseScenario("the branch's scenario", text, "its robot", original.robot_text);
  if (changed.end_step != 0 && changed.end_step <= step) {
    throw UsageError("--set duration_s: expected an end after the step of the branch, " + secondsText(step, scenario) +
                     " s, found " + secondsText(changed.end_step, scenario) + " s");
  }
  const fs::path folder = stateFolder() / "branches" / newRunId();
  makeFolder(folder);
  const CheckpointSet set = checkpointAt(fork, folder, request.run);

  RunRequest run = request.run;
  run.reads = request.files.paths();
  if (run.out.empty()) run.out = (folder / (scenario.name + ".mcap")).string();
  nlohmann::ordered_json result = runFrom(set, folder, text, original, run, exit_code);
  result["branch_of"] = fs::absolute(original.file.first()).string();
  result["branch_step"] = step;
  if (request.json) {
    sayText(toText(result) + '\n');
  } else {
    printResult(result);
  }
}

}  // namespace

void addBranchCommand(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<BranchRequest>();
  CLI::App* command =
      app.add_subcommand("branch", "go on from a step of a recorded run, with another controller or other values");
  command->footer(
      "Starts from the checkpoints in the recording; steps between the last one and STEP are repeated first, and have\n"
      "to come out the same. Without a change the branch gives the bytes of the original run.\n"
      "  baton branch run.mcap --at 4000 --swap tracking\n"
      "  baton branch run.mcap --at-time 2 --set controllers.impedance.parameters.kp=300 --set duration_s=6");
  addRecording(*command, request->recording, "recording",
               "recording of a run (MCAP); several, or a folder of them: read as one");
  auto* at = command->add_option("--at", request->at_step, "step to go on from");
  addAtTime(*command, request->at_s, at);
  command->add_option("--swap", request->swap, "hand over to this controller, as soon as the margin allows");
  command->add_option("--set", request->set, "path=value in the scenario, from that step on")->allow_extra_args(false);
  command->add_option("--out", request->run.out, "file to record to (default: in a folder of the branch's own)");
  command->add_flag("--overwrite", request->run.overwrite, "replace the file --out names");
  addCellOptions(*command, request->run.cell, request->run.domain);
  addTransport(*command, request->run.transport);
  command->add_flag("--json", request->json, "print the result as JSON");
  command->callback([=, &exit_code] {
    ExitCode holes = ExitCode::kOk;
    request->files = findRecording(request->recording, holes);
    branch(*request, exit_code);
    if (exit_code == ExitCode::kOk) exit_code = holes;
  });
}

}  // namespace baton
