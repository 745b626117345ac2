#include "demo_command.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <vector>

#include "control/parameters.hpp"
#include "mcap/reader.hpp"
#include "run_commands.hpp"
#include "runtime/log.hpp"
#include "runtime/paths.hpp"
#include "runtime/recorded_messages.hpp"
#include "runtime/say.hpp"
#include "runtime/scenario.hpp"

namespace baton {
namespace {

/// Vertical contact force of the recording, by step.
std::map<std::uint64_t, double> contactForce(const std::string& recording) {
  std::map<std::uint64_t, double> force_N;
  const mcap::Reader reader(recording);
  forEachMessageOf(dds::topics::kContact, reader, 0,
                   [&](const msg::Contact& contact, const auto&) { force_N[contact.step()] = contact.force()[2]; });
  return force_N;
}

/// Force an impedance of stiffness Kp presses with on a wall of stiffness Ke at rest: Kp (z_d - z) = Ke (z - z_r).
double impedanceForce(const Scenario& scenario, const ControllerConfig& controller) {
  const PlaneSpec& wall = scenario.walls.front();
  const double Kp = numbers(controller.parameters, "kp").at(2);
  const double Ke = wall.stiffness_N_per_m;
  Reference goal;
  const Trajectory trajectory(scenario.robot, scenario.trajectory);
  trajectory.evaluate(trajectory.endTime(), goal);
  return Kp * Ke / (Kp + Ke) * (goal.X_WE.p.z() - wall.point_m.z());
}

/// What each controller that held the baton in contact came to rest at, before the next took over.
void compareForces(const Scenario& scenario, const nlohmann::ordered_json& swaps, const std::string& recording) {
  const std::map<std::uint64_t, double> force_N = contactForce(recording);
  const auto at = [&](std::uint64_t step) { return force_N.contains(step) ? force_N.at(step) : std::nan(""); };
  say("contact     [N, upwards]            measured     predicted\n");
  std::vector<nlohmann::ordered_json> done;
  for (const auto& swap : swaps) {
    if (swap.at("done").get<bool>()) done.push_back(swap);
  }
  for (std::size_t i = 0; i < done.size(); ++i) {
    const ControllerConfig& controller = scenario.controller(done[i].at("incoming").get<std::string>());
    const bool is_last = i + 1 == done.size();
    const std::uint64_t until = is_last ? scenario.end_step : done[i + 1].at("at_step").get<std::uint64_t>() - 1;
    const double predicted =
        controller.law == "force_pi" ? scenario.trajectory.h_d[2] : impedanceForce(scenario, controller);
    say("  %-9s at %.1f s, at rest   %10.6f    %10.6f  (%s)\n", controller.name.c_str(),
        static_cast<double>(until) * scenario.stepSeconds(), at(until), predicted,
        controller.law == "force_pi" ? "f_d" : "Kp Ke / (Kp + Ke) (z_d - z_r)");
  }
}

/// Runs a program to its end in the foreground.
ExitCode runProgram(const std::filesystem::path& program, std::vector<std::string> arguments) {
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid == 0) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  int how = 0;
  while (waitpid(pid, &how, 0) < 0 && errno == EINTR) {  // by Ctrl-C, which ends the program too
  }
  return WIFEXITED(how) ? static_cast<ExitCode>(WEXITSTATUS(how)) : ExitCode::kFailed;
}

ExitCode demo(const RunRequest& request) {
  const Scenario scenario = loadScenario(findScenario(request.scenario).string());
  say("%s: %s\n%zu controllers, a wall, a trajectory, a plant and a recorder, each a process of its own, talk over "
      "DDS.\n\n",
      scenario.name.c_str(), scenario.description.c_str(), scenario.controllers.size());
  flushSaid();
  RunSession session(request, true);
  const ExitCode run_code = runToTheEnd(session);
  const nlohmann::ordered_json result = session.result();
  printResult(result);
  if (run_code != ExitCode::kOk) {
    say(stderr, "baton: the end of %s:\n%s", session.logFile().c_str(), lastLines(session.logFile(), 8).c_str());
    return run_code;
  }
  const std::string recording = session.info().recording;
  compareForces(scenario, result.at("swaps"), recording);

  say("\nreplaying the first 2 seconds of the recording, as its own writers on DDS\n");
  const ExitCode replay_code = runProgram(siblingProgram("baton-replayer"),
                                          {recording, "--to", "2", "--domain", std::to_string(request.domain)});
  if (session.wasInterrupted()) return ExitCode::kInterrupted;
  const char* baton = isInstalled() ? "baton" : "deploy/baton";
  sayText(
      fmt::format("\nnext, try\n"
                  "  {0} bag info {1}\n"
                  "  {0} up lab      then: {0} controllers, {0} swap tracking, {0} down\n"
                  "  {0} model --robot rpp --q pi/3 0.1 0.1\n",
                  baton, recording));
  return replay_code;
}

}  // namespace

void addDemoCommand(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<RunRequest>();
  request->scenario = "demo";
  request->cell = "demo";
  CLI::App* command = app.add_subcommand(
      "demo", "the main job in a minute: path, contact, live handovers, a refusal, a failover, recording, replay");
  addCellOptions(*command, request->cell, request->domain);
  command->callback([=, &exit_code] { exit_code = demo(*request); });
}

}  // namespace baton
