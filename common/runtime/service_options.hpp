/// What every service is told on its command line; the supervisor writes it, a person may.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dds/participant.hpp"
#include "runtime/scenario.hpp"
#include "runtime/scheduling.hpp"

namespace baton {

struct ServiceOptions {
  std::string role;  // "plant", "controller", ...
  std::string name;  // unique in the run; the role unless it is a controller
  std::string scenario_file;
  std::string robot_file;    // empty: the one the scenario names
  std::string cell = "lab";  // one robot with its parts
  std::string run;           // this run of the cell
  int domain = 0;
  dds::Transport transport = dds::Transport::kUdp;
  bool recording = true;      // whether a recorder takes part
  bool record_later = false;  // it waits for a request to begin
  std::string law;            // controller: must agree with the scenario when given
  std::string out;            // recorder: file to write
  Scheduling scheduling;
  std::string checkpoint;      // file to start from instead of step 0; empty: none
  bool starts_paused = false;  // plant: waits for a request before its first step
  bool supervised = false;     // plant, recorder: a supervisor takes part, who must hear how the run goes
  std::string key_file;        // with the run's key; empty: everybody is heard
  bool is_open = false;        // requests are taken from anybody
  dds::WallClock clock{};      // of the run

  /// Throws UnavailableError when the key cannot be read.
  [[nodiscard]] dds::ParticipantOptions participant() const;
};

/// Reads the command line of a service. Throws UsageError; prints help and returns false for --help.
[[nodiscard]] bool parseServiceOptions(int argc, char** argv, const std::string& role, ServiceOptions& options);

/// The arguments that make parseServiceOptions return `options`.
[[nodiscard]] std::vector<std::string> toArguments(const ServiceOptions& options);

/// Names of all services a scenario needs, the plant first.
[[nodiscard]] std::vector<std::string> serviceNames(const Scenario& scenario);
/// The same without one of them: everybody that one has to do with.
[[nodiscard]] std::vector<std::string> servicesBut(const std::string& name, const Scenario& scenario);
[[nodiscard]] std::vector<std::string> controllerNames(const Scenario& scenario);
/// `names` and, in a run that is recorded, the recorder: the readers of a topic that must be whole in the recording.
[[nodiscard]] std::vector<std::string> withRecorder(std::vector<std::string> names, const Scenario& scenario);

/// `names` and, in a run that has one, the supervisor: the readers of what its result is made of.
[[nodiscard]] std::vector<std::string> withSupervisor(std::vector<std::string> names, const ServiceOptions& options);

inline constexpr const char* kPlantName = "plant";
inline constexpr const char* kEnvironmentName = "environment";
inline constexpr const char* kTrajectoryName = "trajectory";
inline constexpr const char* kRecorderName = "recorder";
inline constexpr const char* kSupervisorName = "supervisor";
inline constexpr const char* kReplayerName = "replayer";
/// Who speaks in the manifest of a service that gave way: the service's own name is the other one's.
inline constexpr const char* kSecondCopyName = "a second copy";
inline constexpr const char* kOperatorPrefix = "operator-";

/// What a process of that name is in a run: a controller, unless the name is one of the above.
[[nodiscard]] dds::Role roleCalled(std::string_view service);

}  // namespace baton
