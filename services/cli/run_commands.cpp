#include "run_commands.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "cell_client.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/log.hpp"
#include "runtime/monolithic_run.hpp"
#include "runtime/paths.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/say.hpp"
#include "runtime/swap_report.hpp"
#include "runtime/timing.hpp"

namespace baton {
namespace {

/// "  2.1 MB recorded, 3 lost".
std::string recordedText(const msg::RecorderStatus& status) {
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "  %.1f MB %s", static_cast<double>(status.bytes()) * 1e-6,
                status.ring() ? "in the ring" : "recorded");
  std::string result = text.data();
  if (status.state() == msg::RECORDER_PAUSED) result += ", paused";
  if (status.lost() > 0) result += ", " + std::to_string(status.lost()) + " lost";
  return result;
}

std::string progressText(const RunProgress& progress) {
  const std::optional<msg::SimStatus>& status = progress.sim;
  if (!status) return "starting";
  std::array<char, 200> text{};
  const double time_s = static_cast<double>(status->time_ns()) * 1e-9;
  switch (status->state()) {
    case msg::SIM_STATE_STARTING:
      return status->waiting_for().size() == 0 ? "starting"
                                               : std::string("starting: waits for ") + status->waiting_for().c_str();
    case msg::SIM_STATE_PAUSED:
      std::snprintf(text.data(), text.size(), "paused at step %llu (%.3f s)",
                    static_cast<unsigned long long>(status->step()), time_s);
      break;
    default: {
      const bool has_end = status->end_step() > 0 && status->step() > 0;
      const double done = has_end ? static_cast<double>(status->step()) / static_cast<double>(status->end_step()) : 0.0;
      const double left_s = has_end ? status->elapsed_s() * (1.0 - done) / done : 0.0;
      std::snprintf(text.data(), text.size(), "step %llu  %.3f s  %s  %3.0f %%  %.0f s left",
                    static_cast<unsigned long long>(status->step()), time_s, status->holder().c_str(), done * 100.0,
                    left_s);
    }
  }
  return text.data() + (progress.recorder ? recordedText(*progress.recorder) : "");
}

void addRunOptions(CLI::App& command, RunRequest& request) {
  command.add_option("scenario", request.scenario, "scenario file, or the name of one that comes with Baton")
      ->required();
  addCellOptions(command, request.cell, request.domain);
  addTransport(command, request.transport);
  command.add_option("--out", request.out, "file to record to (default: in the run's folder)");
  command.add_flag("--overwrite", request.overwrite, "replace the file --out names");
  command.add_flag("--no-recording", request.no_recording, "run without a recorder");
  command.add_flag("--record-later", request.record_later, "record nothing before `baton record start`")
      ->excludes("--no-recording");
  addScheduling(command, request.scheduling);
  command.add_flag("--open", request.is_open,
                   "take requests (swap, param, sim, record, controller) from anybody on this machine");
  command
      .add_option("--restarts", request.restarts, "how often a part that dies is started again; not plant and recorder")
      ->check(wholeBetween(0, 1000));
}

void tell(const nlohmann::ordered_json& result, bool json) {
  if (json) {
    sayText(toText(result) + '\n');
  } else {
    printResult(result);
  }
}

/// The whole run in this process. Returns what result.json would say, as far as it applies.
nlohmann::ordered_json runInProcess(const std::string& scenario_name) {
  const auto secondsSince = [](std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
  };
  const std::chrono::steady_clock::time_point launched = std::chrono::steady_clock::now();
  const std::string file = findScenario(scenario_name).string();
  const Scenario scenario = loadScenario(file);
  for (const std::string& warning : scenario.warnings) sayWarning(warning);
  if (scenario.end_step == 0) {
    throw UsageError(file + ": expected a scenario with an end (duration_s), found none");
  }
  MonolithicRun run(scenario);
  ProgressLine line;
  msg::SimStatus status;
  status.state(msg::SIM_STATE_RUNNING);
  status.end_step(scenario.end_step);
  status.holder(scenario.active);
  const double startup_s = secondsSince(launched);
  const std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  Histogram period_ns;
  std::chrono::steady_clock::time_point opened = started;
  while (run.step()) {
    const std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now();
    period_ns.record(std::chrono::nanoseconds(now - opened).count());
    opened = now;
    constexpr std::uint64_t kShownEvery = 1000;  // steps
    if (run.steps() % kShownEvery != 0) continue;
    status.step(run.steps());
    status.time_ns(stampOf(run.steps(), scenario.step_ns).time_ns);
    status.elapsed_s(secondsSince(started));
    line.show(progressText({.sim = status, .recorder = {}}));
  }
  const double elapsed_s = secondsSince(started);
  const double sim_time_s = static_cast<double>(run.steps()) * scenario.stepSeconds();
  msg::TimingStatus timing;
  timing.step(run.steps());
  timing.period(timeSpread(period_ns));
  const bool finished = run.failure().empty();
  const ExitCode ended = finished ? ExitCode::kFailed : ExitCode::kAborted;
  const std::string reason = run.whatWentWrong();
  auto swaps = nlohmann::ordered_json::array();
  for (const msg::SwapOutcome& failover : run.failovers()) {
    nlohmann::ordered_json& one = swaps.emplace_back(baton::toJson(failover));
    one["report"] = nullptr;  // what it did to the arm is not measured
  }
  return {{"scenario", scenario.name},
          {"scenario_file", file},
          {"state", finished ? "finished" : "aborted"},
          {"exit_code", static_cast<int>(reason.empty() ? ExitCode::kOk : ended)},
          {"reason", reason},
          {"step_ns", scenario.step_ns},
          {"steps", run.steps()},
          {"sim_time_s", sim_time_s},
          {"elapsed_s", elapsed_s},
          {"real_time_ratio", elapsed_s > 0.0 ? sim_time_s / elapsed_s : 0.0},
          {"startup_s", startup_s},
          {"missed_steps", 0},
          {"timing", baton::toJson(timing)},
          {"chain_hash", std::to_string(run.chainHash())},
          {"recording", nullptr},
          {"swaps", swaps}};
}

void up(const RunRequest& request, ExitCode& exit_code) {
  RunSession session(request, false);
  ProgressLine line;
  const std::optional<ExitCode> ended =
      session.follow([&](const auto& status) { line.show(progressText(status)); },
                     [](const msg::SimStatus& status) { return status.state() != msg::SIM_STATE_STARTING; });
  line.show("");
  if (ended == ExitCode::kInterrupted) throw Error(ExitCode::kInterrupted, "interrupted before the run began");
  if (ended && *ended != ExitCode::kOk) {
    say(stderr, "baton: the run did not start; the end of %s:\n%s", session.logFile().c_str(),
        lastLines(session.logFile(), 8).c_str());
    exit_code = *ended;
    return;
  }
  say("up: run %s in cell %s, domain %d\nlogs %s\n", session.info().run.c_str(), session.info().cell.c_str(),
      session.info().domain, session.info().folder.c_str());
  if (!session.info().recording.empty()) say("recording %s\n", session.info().recording.c_str());
  const std::string where = (session.info().cell == "lab" ? "" : " --cell " + session.info().cell) +
                            (session.info().domain == 0 ? "" : " --domain " + std::to_string(session.info().domain));
  say("try:");
  for (const char* command : {" baton status", " | baton controllers", " | baton swap NAME", " | baton down"}) {
    say("%s%s", command, where.c_str());
  }
  say("\n");
}

void down(const std::string& cell, int domain, bool json, ExitCode& exit_code) {
  const RunInfo info = CellClient::find(domain, cell);
  if (kill(info.supervisor_pid, SIGTERM) != 0) {
    throw UnavailableError("cannot stop process " + std::to_string(info.supervisor_pid) +
                           ": it belongs to somebody else");
  }
  kill(info.supervisor_pid, SIGCONT);  // who is stopped would never hear of it
  ProgressLine line;
  const auto isThere = [&] {
    const std::optional<RunInfo> now = activeRun(domain, cell);
    return now && now->run == info.run;
  };
  for (int waited_ms = 0; isThere(); waited_ms += 50) {
    if (waited_ms > 500) line.show("waiting for the recording to be closed");
    if (waited_ms > 150'000) {
      throw Error(ExitCode::kFailed, "the run does not end; see " + info.folder +
                                         "/supervisor.log, and as a last resort kill -9 " +
                                         std::to_string(info.supervisor_pid) + ", which ends all its processes");
    }
    usleep(50'000);
  }
  line.show("");
  const nlohmann::ordered_json result = readResult(info.folder);
  tell(result, json);
  const bool is_complete = result.at("recording").is_null() || result.at("recording").at("complete").get<bool>();
  exit_code = is_complete ? ExitCode::kOk : ExitCode::kFailed;
}

void logs(const std::string& cell, int domain, const std::string& service, int lines) {
  std::filesystem::path folder;
  if (const std::optional<RunInfo> run = activeRun(domain, cell)) {
    folder = run->folder;
  } else {
    // The newest run there was: folders sort by time.
    for (const std::filesystem::path& one : listFolder(stateFolder() / "runs")) folder = std::max(folder, one);
    if (folder.empty()) throw UnavailableError("no run has been started yet: baton up SCENARIO");
  }
  std::string names;
  bool found = false;
  for (const std::filesystem::path& log : listFolder(folder)) {
    if (log.extension() != ".log") continue;
    const std::string name = log.stem().string();
    names += (names.empty() ? "" : ", ") + name;
    if (!service.empty() && name != service) continue;
    found = true;
    say("%s\n%s", log.c_str(), lastLines(log, static_cast<std::size_t>(lines)).c_str());
  }
  if (names.empty()) throw UnavailableError(folder.string() + " has no logs: its run ended before it began");
  if (!found) throw UsageError("no log of " + service + ": expected one of " + names);
}

}  // namespace

void addCellOptions(CLI::App& command, std::string& cell, int& domain) {
  addCell(command, cell);
  addDomain(command, domain)->envname("BATON_DOMAIN");
}

ExitCode runToTheEnd(RunSession& session) {
  ProgressLine line;
  const std::optional<ExitCode> ended = session.follow([&](const auto& status) { line.show(progressText(status)); },
                                                       [](const msg::SimStatus&) { return false; });
  return ended.value_or(ExitCode::kFailed);
}

void addRunCommands(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<RunRequest>();
  const auto json = std::make_shared<bool>(false);

  CLI::App* run_command = app.add_subcommand("run", "run a scenario to its end");
  addRunOptions(*run_command, *request);
  run_command->add_flag("--json", *json, "print the result as JSON");
  const auto in_process = std::make_shared<bool>(false);
  CLI::Option* in_process_option = run_command->add_flag(
      "--in-process", *in_process,
      "all parts in this process, without DDS and recording, as fast as possible: the same bytes, the same hash");
  for (const char* other :
       {"--out", "--overwrite", "--no-recording", "--record-later", "--restarts", "--fifo", "--cpus", "--open"}) {
    in_process_option->excludes(other);
  }
  run_command->callback([=, &exit_code] {
    if (*in_process) {
      const nlohmann::ordered_json result = runInProcess(request->scenario);
      exit_code = static_cast<ExitCode>(result.at("exit_code").get<int>());
      return tell(result, *json);
    }
    RunSession session(*request, true);
    exit_code = runToTheEnd(session);
    const nlohmann::ordered_json result = session.result();
    tell(result, *json);
    if (result.at("state") == "not_started") {
      say(stderr, "baton: the end of %s:\n%s", session.logFile().c_str(), lastLines(session.logFile(), 8).c_str());
    }
  });

  CLI::App* up_command = app.add_subcommand("up", "start a scenario and leave it running");
  addRunOptions(*up_command, *request);
  up_command->add_flag("--paused", request->paused, "wait for `baton sim resume` or `sim step` before the first step");
  up_command->callback([=, &exit_code] { up(*request, exit_code); });

  CLI::App* down_command = app.add_subcommand("down", "end the run in a cell, in order, and tell how it went");
  addCellOptions(*down_command, request->cell, request->domain);
  down_command->add_flag("--json", *json, "print the result as JSON");
  down_command->callback([=, &exit_code] { down(request->cell, request->domain, *json, exit_code); });

  const auto service = std::make_shared<std::string>();
  const auto lines = std::make_shared<int>(20);
  CLI::App* logs_command =
      app.add_subcommand("logs", "the last lines of a service's log, or of all; of the newest run when none is up");
  logs_command->add_option("service", *service, "plant, recorder, supervisor, a controller's name, ...");
  logs_command->add_option("--lines", *lines, "how many")->check(wholeBetween(1, 1'000'000))->capture_default_str();
  addCellOptions(*logs_command, request->cell, request->domain);
  logs_command->callback([=] { logs(request->cell, request->domain, *service, *lines); });
}

}  // namespace baton
