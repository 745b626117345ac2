#include "rerun_command.hpp"

#include <filesystem>
#include <memory>

#include "rerun.hpp"
#include "run_commands.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

struct RerunRequest {
  RecordingWish recording;
  RunRequest run;
  bool json = false;
};

nlohmann::ordered_json toJson(const Rerun& made, const std::string& recording) {
  nlohmann::ordered_json json{{"file", recording},           {"identical", made.isIdentical()},
                              {"steps", made.steps},         {"steps_compared", made.comparison.steps},
                              {"decisions", made.decisions}, {"hash", std::to_string(made.hash)},
                              {"verdict", made.text()}};
  if (const auto& parting = made.comparison.parting) {
    json["first_different_step"] = parting->step;
    json["topic"] = parting->topic;
  } else if (made.first_missing) {
    json["first_missing_step"] = *made.first_missing;
  }
  json["made_with"] = nlohmann::ordered_json::object();
  for (const MadeWithDifference& one : made.made_with) {
    json["made_with"][one.key] = {{"recording", one.then}, {"now", one.now}};
  }
  json["rerun"] = made.result;
  return json;
}

/// What was made until something went wrong is there to look into, where it says; nothing leaves nothing.
Rerun rerunIn(const fs::path& folder, const mcap::FileList& files, const RunRequest& run) {
  const bool was_there = fs::exists(run.out);
  try {
    return rerun(files, folder, run, runToTheEnd);
  } catch (const std::exception&) {
    if (!was_there && fs::exists(run.out)) {
      say(stderr, "baton: what was repeated is in %s\n", folder.c_str());
    } else {
      fs::remove_all(folder);
    }
    throw;
  }
}

void tellRerun(const RerunRequest& request, ExitCode& exit_code) {
  ExitCode holes = ExitCode::kOk;
  const mcap::FileList files = findRecording(request.recording, holes);
  const fs::path folder = stateFolder() / "reruns" / newRunId();
  makeFolder(folder);
  const bool is_kept = !request.run.out.empty();
  RunRequest run = request.run;
  run.reads = files.paths();
  if (!is_kept) run.out = (folder / "rerun.mcap").string();
  const Rerun made = rerunIn(folder, files, run);
  const bool is_recorded = fs::exists(made.recording);
  if (request.json) {
    sayText(toText(toJson(made, files.string())) + '\n');
  } else {
    say("%s\n", made.text().c_str());
    if (is_recorded && (is_kept || !made.isIdentical())) say("recording %s\n", made.recording.c_str());
  }
  if (made.isIdentical() || !is_recorded) fs::remove_all(folder);  // else it is there to look into
  exit_code = made.isIdentical() ? holes : ExitCode::kFailed;
  if (made.was_interrupted) exit_code = ExitCode::kInterrupted;
}

}  // namespace

void addRerunCommand(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<RerunRequest>();
  request->run.cell = "rerun";
  CLI::App* command =
      app.add_subcommand("rerun", "do a recorded run again, from its file alone, and compare the bytes");
  command->footer(
      "Everything that was decided while the run went on is in the recording: handovers and parameters that operators\n"
      "asked for, controllers that were lost and came back, where it was stopped. These are repeated at their steps,\n"
      "with processes that live and without timers, and every payload of the loop is compared.\n"
      "Exit codes: 0 identical, 1 they differ: it names what differs of what recorded the two, then the first step\n"
      "and topic; 130 interrupted.");
  addRecording(*command, request->recording, "recording",
               "recording of a run in lockstep (MCAP); several, or a folder of them: read as one");
  command->add_option("--out", request->run.out, "file to record to (default: kept only when it differs)");
  command->add_flag("--overwrite", request->run.overwrite, "replace the file --out names");
  addCellOptions(*command, request->run.cell, request->run.domain);
  addTransport(*command, request->run.transport);
  command->add_flag("--json", request->json, "print the verdict as JSON");
  command->callback([=, &exit_code] { tellRerun(*request, exit_code); });
}

}  // namespace baton
