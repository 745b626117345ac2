#include "supervise.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

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
  std::string transport = "udp";
  info.cell = "lab";
  CLI::App app{
      "Runs a scenario: starts its processes, watches them and ends them in order. `baton up` and `baton run` start "
      "it."};
  app.add_option("--scenario", info.scenario, "scenario file")->required();
  app.add_option("--cell", info.cell, "cell to use")->check(cellName())->capture_default_str();
  app.add_option("--run", info.run, "id of the run (default: the time)");
  app.add_option("--domain", info.domain, "DDS domain")->check(CLI::Range(0, 232))->capture_default_str();
  app.add_option("--transport", transport, "udp or shm")->check(CLI::IsMember({"udp", "shm"}))->capture_default_str();
  app.add_option("--out", info.recording, "recording to write (default: in the run's folder)");
  app.add_flag("--no-recording", no_recording, "without a recorder");
  app.add_option("--restarts", deployment.restarts, "how often a controller that dies is started again, to stand by")
      ->check(CLI::Range(0, 1000));
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    app.exit(help);
    return ExitCode::kOk;
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + " (see --help)");
  }
  if (info.run.empty()) info.run = newRunId();
  info.transport = transport == "shm" ? dds::Transport::kSharedMemory : dds::Transport::kUdp;
  info.folder = runFolder(info.run).string();
  info.supervisor_pid = getpid();
  setUpLog("supervisor");

  Scenario scenario = loadScenario(info.scenario);
  scenario.recording.enabled = scenario.recording.enabled && !no_recording;
  if (!scenario.recording.enabled) {
    info.recording.clear();
  } else if (info.recording.empty()) {
    info.recording = (std::filesystem::path(info.folder) / (scenario.name + ".mcap")).string();
  }
  const CellLock lock(info);
  // The run keeps the experiment as it was, whatever becomes of the files.
  std::ofstream(std::filesystem::path(info.folder) / "scenario.yaml") << scenario.text;
  std::ofstream(std::filesystem::path(info.folder) / "robot.yaml") << scenario.robot_text;

  ServiceOptions options;
  options.role = options.name = "supervisor";
  options.scenario_file = info.scenario;
  options.cell = info.cell;
  options.run = info.run;
  options.domain = info.domain;
  options.transport = info.transport;
  options.recording = scenario.recording.enabled;
  Service service(options, std::move(scenario));
  held.release();
  Supervisor supervisor(service, deployment);
  return supervisor.run();
}

}  // namespace baton
