#include "supervise.hpp"

#include <unistd.h>

#include <filesystem>
#include <optional>

#include "dds/parting.hpp"
#include "runtime/command_line.hpp"
#include "runtime/log.hpp"
#include "runtime/paths.hpp"
#include "runtime/signals.hpp"
#include "supervisor.hpp"

namespace baton {

ExitCode supervise(int argc, char** argv) {
  const HeldSignals held;
  Deployment deployment;
  RunInfo& info = deployment.info;
  bool no_recording = false;
  info.cell = "lab";
  CLI::App app{
      "Runs a scenario: starts its processes, watches them and ends them in order. `baton up` and `baton run` start "
      "it."};
  app.add_option("--scenario", info.scenario, "scenario file")->required();
  addCell(app, info.cell);
  app.add_option("--run", info.run, "id of the run (default: the time)");
  addDomain(app, info.domain);
  addTransport(app, info.transport);
  app.add_option("--out", info.recording, "recording to write (default: in the run's folder)");
  app.add_flag("--no-recording", no_recording, "without a recorder");
  app.add_option("--restarts", deployment.restarts,
                 "how often a part that dies is started again; not plant and recorder")
      ->check(wholeBetween(0, 1000));
  std::string checkpoint;
  bool starts_paused = false, record_later = false, is_open = false;
  Scheduling scheduling;
  addScheduling(app, scheduling);
  app.add_option("--checkpoint", checkpoint, "checkpoint to go on from, instead of the scenario's start");
  app.add_flag("--record-later", record_later, "the recorder waits for `record start`");
  app.add_flag("--paused", starts_paused, "wait for `sim resume` before the first step");
  app.add_flag("--open", is_open, "requests are taken from anybody");
  addClock(app, info.clock);
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;
  if (info.run.empty()) info.run = newRunId();
  info.folder = runFolder(info.run).string();
  info.supervisor_pid = getpid();
  setUpLog(kSupervisorName);

  Scenario scenario = loadScenario(info.scenario);
  scenario.recording.enabled = scenario.recording.enabled && !no_recording;
  if (!scenario.recording.enabled) {
    info.recording.clear();
  } else if (info.recording.empty()) {
    info.recording = (std::filesystem::path(info.folder) / (scenario.name + ".mcap")).string();
  }
  std::optional<CellLock> lock(info);
  // The run keeps the experiment as it was, whatever becomes of the files.
  keepExperiment(info, scenario);
  makeKeyWhenMissing(info);

  ServiceOptions options;
  options.role = options.name = kSupervisorName;
  options.scenario_file = keptScenario(info);
  options.robot_file = keptRobot(info);
  options.cell = info.cell;
  options.run = info.run;
  options.domain = info.domain;
  options.transport = info.transport;
  options.recording = scenario.recording.enabled;
  options.checkpoint = checkpoint;
  options.starts_paused = starts_paused;
  options.supervised = true;
  options.record_later = record_later;
  options.scheduling = scheduling;
  options.key_file = keyFile(info);
  options.is_open = is_open;
  options.clock = info.clock;
  const dds::Parting<Service> service(options, std::move(scenario));
  held.release();
  const ExitCode code = Supervisor(*service, deployment).run();
  lock.reset();  // the cell is free, however long DDS takes
  return code;
}

}  // namespace baton
