#include "runtime/run.hpp"

#include <spdlog/spdlog.h>

#include <csignal>
#include <filesystem>

#include "base/text.hpp"
#include "dds/parting.hpp"
#include "runtime/log.hpp"
#include "runtime/say.hpp"
#include "runtime/signals.hpp"

namespace baton {

namespace {

void tell(const std::string& name, const std::string& message, const std::string& details = "") {
  // It may name what a recording or another process calls itself.
  sayText(escaped(name + ": " + message) + '\n' + details, stderr);
}

int guarded(const std::string& name, const std::function<ExitCode()>& body) {
  try {
    return static_cast<int>(body());
  } catch (const Error& error) {
    tell(name, error.what(), error.details());
    return static_cast<int>(error.code());
  } catch (const std::filesystem::filesystem_error& error) {
    tell(name, "cannot use " + error.path1().string() + ": " + error.code().message());
    return static_cast<int>(ExitCode::kUnavailable);
  } catch (const std::exception& error) {
    tell(name, std::string("unexpected: ") + error.what());
    return static_cast<int>(ExitCode::kFailed);
  }
}

}  // namespace

int runGuarded(const std::string& name, const std::function<ExitCode()>& body) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit is an error of a write, as on a full disk
  int exit_code = guarded(name, body);
  if (const std::string why = flushSaid(); !why.empty()) {
    tell(name, "standard output cannot be written: " + why);
    if (exit_code == 0) exit_code = static_cast<int>(ExitCode::kUnavailable);
  }
  return dds::leave(exit_code);
}

int runService(int argc, char** argv, const std::string& role, const std::function<ExitCode(Service&)>& body) {
  return runGuarded("baton-" + role, [&] {
    const HeldSignals held;
    ServiceOptions options;
    if (!parseServiceOptions(argc, argv, role, options)) return ExitCode::kOk;
    setUpLog(options.name);
    Scenario scenario = loadScenario(options.scenario_file, options.robot_file);
    scenario.recording.enabled = scenario.recording.enabled && options.recording;
    scenario.recording.starts_stopped = scenario.recording.starts_stopped || options.record_later;
    // DDS's threads inherit it.
    const std::vector<std::string> refusals = applyScheduling(options.scheduling, scenario.mode == SimMode::kLockstep);
    Service service(options, std::move(scenario));
    for (const std::string& refusal : refusals) service.event(msg::SEVERITY_WARNING, "scheduling", refusal);
    held.release();
    const ExitCode code = body(service);
    spdlog::info("stopped exit_code={}", static_cast<int>(code));
    return code;
  });
}

}  // namespace baton
