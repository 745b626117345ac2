#include "kills_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "kills/kill_judge.hpp"
#include "mcap/reader.hpp"
#include "rerun.hpp"
#include "run_commands.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

struct KillsRequest {
  std::string scenario = "kills";
  std::size_t runs = 200;
  std::uint64_t seed = 1;
  std::string out;
  RunRequest run;
  bool json = false;
};

struct Trial {
  Kill kill;
  KilledRun run;
  double largest_torque = 0.0;  // in parts of the limit
  std::string objection;        // empty: it ended as told
  std::string repetition;       // the verdict on its repetition
  bool is_repeated = false;
  fs::path recording;
  [[nodiscard]] bool isGood() const { return objection.empty() && is_repeated; }
};

void expectUninterrupted(ExitCode code) {
  if (code == ExitCode::kInterrupted) throw Error(ExitCode::kInterrupted, "interrupted");
}

Trial tryOne(const Kill& kill, const Scenario& scenario, const std::string& undisturbed_hash, const fs::path& folder,
             const KillsRequest& request) {
  const std::string name = fmt::format("{:03}-{}-{}", kill.number, toString(kill.of.victim), toString(kill.of.way));
  const fs::path own = folder / name;
  makeFolder(own);
  Trial trial{.kill = kill, .run = {}, .objection = {}, .repetition = {}, .recording = folder / (name + ".mcap")};
  RunRequest run = request.run;
  run.out = trial.recording.string();
  run.overwrite = true;
  trial.run = killRun(scenario, kill, own, run);
  expectUninterrupted(trial.run.exit_code);
  const PlantRecord record = readPlantRecord(trial.recording, scenario, trial.run.service);
  trial.largest_torque = record.largest_torque;
  trial.objection = objectionTo(kill, trial.run, record, scenario, undisturbed_hash);

  run.out = (own / "rerun.mcap").string();
  ExitCode code = ExitCode::kOk;
  try {
    const Rerun again = rerun(trial.recording, own, run,
                              [&](RunSession& session) { return code = followToItsEnd(session, [](const auto&) {}); });
    trial.repetition = again.text();
    trial.is_repeated = again.isIdentical();
  } catch (const UsageError& error) {
    trial.repetition = error.what();  // the recording has nothing that could be repeated
  }
  expectUninterrupted(code);
  if (!trial.isGood()) return trial;
  fs::remove_all(own);
  if (request.out.empty()) fs::remove(trial.recording);
  return trial;
}

std::string progressText(std::size_t done, std::size_t of, double elapsed_s, std::size_t failed) {
  const double left_s = done > 0 ? elapsed_s * static_cast<double>(of - done) / static_cast<double>(done) : 0.0;
  return fmt::format("{} {} of {}  {} failed  {}", progressBar(static_cast<double>(done) / static_cast<double>(of)),
                     done, of, failed, done > 0 ? fmt::format("{:.0f} s left", left_s) : "");
}

/// One line of the table.
struct KillRow {
  KillCase of;
  std::size_t runs = 0, as_told = 0, repeated = 0;
  double largest_torque = 0.0;
};

std::vector<KillRow> tableOf(const std::vector<Trial>& trials) {
  std::vector<KillRow> rows;
  for (const KillCase& of : killCases()) {
    KillRow row{.of = of};
    for (const Trial& trial : trials) {
      if (!(trial.kill.of == of)) continue;
      ++row.runs;
      if (trial.objection.empty()) ++row.as_told;
      if (trial.is_repeated) ++row.repeated;
      row.largest_torque = std::max(row.largest_torque, trial.largest_torque);
    }
    if (row.runs > 0) rows.push_back(row);
  }
  return rows;
}

nlohmann::ordered_json toJson(const Trial& trial) {
  return {{"number", trial.kill.number},
          {"victim", toString(trial.kill.of.victim)},
          {"way", toString(trial.kill.of.way)},
          {"service", trial.run.service},
          {"step", trial.run.step},
          {"state", trial.run.result.at("state")},
          {"reason", trial.run.result.at("reason")},
          {"largest_torque", trial.largest_torque},
          {"ended_as_told", trial.objection.empty()},
          {"objection", trial.objection},
          {"repeated", trial.is_repeated},
          {"rerun", trial.repetition},
          {"recording", fs::exists(trial.recording) ? trial.recording.string() : ""}};
}

void print(const std::vector<Trial>& trials, const KillsRequest& request, double elapsed_s) {
  if (request.json) {
    nlohmann::ordered_json json{{"seed", request.seed}, {"runs", trials.size()}, {"trials", nlohmann::json::array()}};
    json["failed"] = std::count_if(trials.begin(), trials.end(), [](const Trial& trial) { return !trial.isGood(); });
    for (const Trial& trial : trials) json["trials"].push_back(toJson(trial));
    sayText(toText(json) + '\n');
    return;
  }
  say("%-12s %-10s %5s  %13s  %14s  %20s\n", "victim", "way", "runs", "ended as told", "largest torque",
      "repeated bit for bit");
  for (const KillRow& row : tableOf(trials)) {
    say("%-12s %-10s %5zu  %13zu  %12.0f %%  %20zu\n", toString(row.of.victim), toString(row.of.way), row.runs,
        row.as_told, 100.0 * row.largest_torque, row.repeated);
  }
  say("torques in parts of the limit; %zu runs and re-runs in %.0f s, seed %llu\n", trials.size(), elapsed_s,
      static_cast<unsigned long long>(request.seed));
  for (const Trial& trial : trials) {
    if (trial.isGood()) continue;
    say("\nrun %llu: %s, the %s, %s at step %llu\n  %s\n  %s\n  %s\n",
        static_cast<unsigned long long>(trial.kill.number), trial.run.service.c_str(), toString(trial.kill.of.victim),
        toString(trial.kill.of.way), static_cast<unsigned long long>(trial.run.step),
        trial.objection.empty() ? "ended as told" : trial.objection.c_str(), trial.repetition.c_str(),
        trial.recording.c_str());
  }
}

void kills(const KillsRequest& request, ExitCode& exit_code) {
  const Scenario scenario = loadScenario(findScenario(request.scenario).string());
  const std::vector<Kill> drawn = drawKills(scenario, request.seed, request.runs);
  const fs::path folder =
      request.out.empty() ? stateFolder() / "kills" / newRunId() : fs::absolute(request.out).lexically_normal();
  const fs::path home = folder / "home";
  makeFolder(home);
  setenv("BATON_HOME", home.c_str(), 1);  // hundreds of runs do not belong among a person's own

  const fs::path undisturbed_folder = folder / "undisturbed";
  makeFolder(undisturbed_folder);
  RunRequest plain = request.run;
  plain.out = (undisturbed_folder / "run.mcap").string();
  plain.overwrite = true;
  const KilledRun undisturbed = killRun(scenario, {}, undisturbed_folder, plain);
  expectUninterrupted(undisturbed.exit_code);
  if (undisturbed.exit_code != ExitCode::kOk) {
    throw Error(ExitCode::kFailed,
                "the run without a kill ended badly: " + undisturbed.result.at("reason").get<std::string>());
  }
  std::vector<Trial> trials;
  std::size_t failed = 0;
  const std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  {
    ProgressLine line;
    for (const Kill& kill : drawn) {
      line.show(progressText(trials.size(), drawn.size(), elapsed(), failed));
      trials.push_back(tryOne(kill, scenario, undisturbed.result.at("chain_hash"), folder, request));
      if (!trials.back().isGood()) ++failed;
    }
  }
  print(trials, request, elapsed());
  if (failed == 0) {
    fs::remove_all(undisturbed_folder);
    fs::remove_all(home);
    if (request.out.empty()) fs::remove_all(folder);
  }
  exit_code = failed == 0 ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addKillsCommand(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<KillsRequest>();
  request->run.cell = "kills";
  CLI::App* command = app.add_subcommand("kills", "kill processes of runs at seeded steps; every run must end as told");
  command->footer(
      "Runs a short scenario in contact again and again, each time with one process ended by SIGKILL or held by\n"
      "SIGSTOP: the holder of the baton, one that stands by, environment, trajectory or recorder. Checks that the run\n"
      "ends as its scenario has it, that every torque is finite and within its limit, and that a re-run from the\n"
      "recording has the same bytes. The same seed gives the same list of kills.\n"
      "Exit codes: 0 all of it held every time, 1 it did not; what did not is told and kept; 130 interrupted.");
  command->add_option("scenario", request->scenario, "another scenario: lockstep, a wall, a planned handover")
      ->capture_default_str();
  command->add_option("--runs", request->runs, "how many")->check(wholeBetween(1, 100'000))->capture_default_str();
  command->add_option("--seed", request->seed, "of the list of kills")->capture_default_str();
  command->add_option("--out", request->out, "folder for all recordings (default: those of failed runs are kept)");
  addCellOptions(*command, request->run.cell, request->run.domain);
  addTransport(*command, request->run.transport);
  command->add_flag("--json", request->json, "print every run as JSON");
  command->callback([=, &exit_code] { kills(*request, exit_code); });
}

}  // namespace baton
