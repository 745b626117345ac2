#include "runtime/service_options.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "runtime/cell.hpp"
#include "runtime/command_line.hpp"

namespace baton {

dds::ParticipantOptions ServiceOptions::participant() const {
  return {.domain = domain,
          .partition = cell + "/" + run,
          .cell = cell,
          .run = run,
          .service = name,
          .role = roleCalled(name),
          .transport = transport,
          .key = key_file.empty() ? std::nullopt : std::optional(readKey(key_file)),
          .strangers = is_open ? dds::Strangers::kSpeakFreely : dds::Strangers::kAsk,
          .clock = clock};
}

bool parseServiceOptions(int argc, char** argv, const std::string& role, ServiceOptions& options) {
  options.role = role;
  options.name = role;
  CLI::App app{"The " + role + " of a Baton run. The supervisor starts it; `baton up` starts the supervisor."};
  app.add_option("--scenario", options.scenario_file, "scenario file, the whole experiment")->required();
  app.add_option("--robot", options.robot_file, "robot file to use instead of the one that the scenario names");
  addCell(app, options.cell);
  app.add_option("--run", options.run, "id of the run within the cell")->required();
  addDomain(app, options.domain);
  addTransport(app, options.transport);
  app.add_option("--checkpoint", options.checkpoint, "checkpoint to go on from, instead of the scenario's start");
  addScheduling(app, options.scheduling);
  app.add_option("--key", options.key_file, "file with the key of the run: only who has it is heard");
  app.add_flag("--open", options.is_open, "requests are taken from anybody");
  addClock(app, options.clock);
  bool no_recording = false;
  app.add_flag("--no-recording", no_recording, "no recorder takes part in this run");
  if (role == "controller") {
    app.add_option("--name", options.name, "the controller's name in the scenario")->required();
    app.add_option("--law", options.law, "its law, to be checked against the scenario");
  }
  if (role == kPlantName)
    app.add_flag("--paused", options.starts_paused, "wait for `sim resume` before the first step");
  if (role == kRecorderName) {
    app.add_option("--out", options.out, "file to write (MCAP)")->required();
    app.add_flag("--record-later", options.record_later, "wait for `record start` before the first sample is kept");
  }
  if (role == kPlantName || role == kRecorderName)
    app.add_flag("--supervised", options.supervised, "wait for the run's supervisor as well");
  if (!parseCommandLine(app, argc, argv)) return false;
  options.recording = !no_recording;
  return true;
}

std::vector<std::string> toArguments(const ServiceOptions& options) {
  std::vector<std::string> arguments{"--scenario",     options.scenario_file,
                                     "--cell",         options.cell,
                                     "--run",          options.run,
                                     "--domain",       std::to_string(options.domain),
                                     "--transport",    dds::toString(options.transport),
                                     "--clock-offset", std::to_string(options.clock.offset())};
  if (!options.robot_file.empty()) arguments.insert(arguments.end(), {"--robot", options.robot_file});
  if (!options.checkpoint.empty()) arguments.insert(arguments.end(), {"--checkpoint", options.checkpoint});
  for (std::string& argument : toArguments(options.scheduling)) arguments.push_back(std::move(argument));
  if (options.starts_paused && options.role == kPlantName) arguments.emplace_back("--paused");
  if (options.supervised && (options.role == kPlantName || options.role == kRecorderName))
    arguments.emplace_back("--supervised");
  if (!options.key_file.empty()) arguments.insert(arguments.end(), {"--key", options.key_file});
  if (options.is_open) arguments.emplace_back("--open");
  if (!options.recording) arguments.emplace_back("--no-recording");
  if (options.role == "controller") arguments.insert(arguments.end(), {"--name", options.name, "--law", options.law});
  if (options.role == kRecorderName) {
    arguments.insert(arguments.end(), {"--out", options.out});
    if (options.record_later) arguments.emplace_back("--record-later");
  }
  return arguments;
}

std::vector<std::string> serviceNames(const Scenario& scenario) {
  std::vector<std::string> names{kPlantName, kTrajectoryName};
  if (scenario.hasEnvironment()) names.emplace_back(kEnvironmentName);
  for (const std::string& name : controllerNames(scenario)) names.push_back(name);
  return withRecorder(std::move(names), scenario);
}

std::vector<std::string> servicesBut(const std::string& name, const Scenario& scenario) {
  std::vector<std::string> names = serviceNames(scenario);
  std::erase(names, name);
  return names;
}

std::vector<std::string> controllerNames(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const ControllerConfig& controller : scenario.controllers) names.push_back(controller.name);
  return names;
}

std::vector<std::string> withRecorder(std::vector<std::string> names, const Scenario& scenario) {
  if (scenario.recording.enabled) names.emplace_back(kRecorderName);
  return names;
}

std::vector<std::string> withSupervisor(std::vector<std::string> names, const ServiceOptions& options) {
  if (options.supervised) names.emplace_back(kSupervisorName);
  return names;
}

dds::Role roleCalled(std::string_view service) {
  using enum dds::Role;
  constexpr std::array<std::pair<std::string_view, dds::Role>, 6> kRoles{{{kPlantName, kPlant},
                                                                          {kEnvironmentName, kEnvironment},
                                                                          {kTrajectoryName, kTrajectory},
                                                                          {kRecorderName, kRecorder},
                                                                          {kReplayerName, kReplayer},
                                                                          {kSupervisorName, kSupervisor}}};
  if (service.starts_with(kOperatorPrefix)) return kOperator;
  const auto found = std::ranges::find(kRoles, service, &std::pair<std::string_view, dds::Role>::first);
  return found == kRoles.end() ? kController : found->second;
}

}  // namespace baton
