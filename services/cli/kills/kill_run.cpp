#include "kills/kill_run.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "dds/parting.hpp"
#include "dds/typed.hpp"
#include "recorded_run.hpp"
#include "runtime/admission.hpp"
#include "runtime/paths.hpp"
#include "runtime/scenario_edit.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {

/// Lets a paused run go and does the deed in its midst: the readers call back on a DDS thread, as near to the step as
/// anybody is. Nobody waits for an observer, so there is a fence: the run pauses a few steps later until it is done.
class Killer {
 public:
  Killer(const RunInfo& info, const std::optional<Kill>& kill)
      : kill_(kill),
        participant_(operatorOf(info)),
        admission_(participant_, false, [](const std::string&) {}),  // the run itself tells
        request_(participant_, dds::topics::kSimRequest),
        services_(
            participant_, dds::topics::kServiceStatus,
            [this](const msg::ServiceStatus& status, const dds::RawSample& sample) {
              if (admission_.speaksFor(sample.writer, status.name().c_str())) onService(status);
            },
            {}, admission_.filter(dds::topics::kServiceStatus)),  // a stranger could name any process
        status_(
            participant_, dds::topics::kSimStatus,
            [this](const msg::SimStatus& status, const dds::RawSample&) { onStatus(status); }, {},
            admission_.filter(dds::topics::kSimStatus)),
        states_(
            participant_, dds::topics::kPlantState,
            [this](const msg::PlantState& state, const dds::RawSample&) { onState(state); }, {},
            admission_.filter(dds::topics::kPlantState)) {}

  /// Whenever one likes: lets the run go once everybody is known.
  void resume(const std::vector<std::string>& services) {
    const std::lock_guard lock(mutex_);
    const bool is_matched = !request_.raw().matched().empty() && !states_.raw().matched().empty();
    const bool are_known =
        std::all_of(services.begin(), services.end(), [this](const std::string& name) { return pids_.contains(name); });
    if (has_resumed_ || !is_paused_ || !is_matched || !are_known) return;
    if (kill_) ask(msg::SIM_PAUSE, kill_->step + kFence_steps);
    ask(msg::SIM_RESUME, 0);
    has_resumed_ = true;
  }

  [[nodiscard]] std::string service() {
    const std::lock_guard lock(mutex_);
    return service_;
  }
  [[nodiscard]] std::uint64_t step() {
    const std::lock_guard lock(mutex_);
    return step_;
  }

 private:
  void ask(msg::SimAction action, std::uint64_t at_step) {
    msg::SimRequest request;
    request.request_id(++requests_);
    request.action(action);
    request.at_step(at_step);
    request_.write(request);
  }

  void onService(const msg::ServiceStatus& status) {
    const std::lock_guard lock(mutex_);
    if (status.state() == msg::SERVICE_READY) pids_[status.name().c_str()] = status.pid();
  }

  void onStatus(const msg::SimStatus& status) {
    const std::lock_guard lock(mutex_);
    is_paused_ = status.state() == msg::SIM_STATE_PAUSED;
    const bool is_over = status.state() == msg::SIM_STATE_FINISHED || status.state() == msg::SIM_STATE_ABORTED;
    if (is_over) goOn();
  }

  void onState(const msg::PlantState& state) {
    const std::lock_guard lock(mutex_);
    if (!kill_ || state.step() < kill_->step) return;
    if (service_.empty()) doTheDeed(state);
    // The plant goes on without a recorder for as long as its credit lasts, and misses it only then.
    const bool is_missed_late = kill_->of.victim == Victim::kRecorder;
    if (state.step() >= step_ + kStopped_steps && !is_missed_late) goOn();
    if (state.step() == kill_->step + kFence_steps) ask(msg::SIM_RESUME, 0);
  }

  void doTheDeed(const msg::PlantState& state) {
    const std::string victim = kill_->service.empty() ? state.holder().c_str() : kill_->service;
    const auto found = pids_.find(victim);
    if (found == pids_.end()) return;
    const bool stops = kill_->of.way == Way::kStopped;
    if (::kill(found->second, stops ? SIGSTOP : SIGKILL) != 0) return;
    if (stops) stopped_pid_ = found->second;
    service_ = victim;
    step_ = state.step();
  }

  void goOn() {
    if (stopped_pid_ > 0) ::kill(stopped_pid_, SIGCONT);
    stopped_pid_ = 0;
  }

  const std::optional<Kill> kill_;
  std::mutex mutex_;
  std::map<std::string, int> pids_;
  bool is_paused_ = false;
  bool has_resumed_ = false;
  std::uint64_t requests_ = 0;
  std::string service_;
  std::uint64_t step_ = 0;
  int stopped_pid_ = 0;  // that waits to go on
  dds::Participant participant_;
  Admission admission_;
  dds::Writer<msg::SimRequest> request_;
  dds::Reader<msg::ServiceStatus> services_;
  dds::Reader<msg::SimStatus> status_;
  dds::Reader<msg::PlantState> states_;
};

}  // namespace

ExitCode followToItsEnd(RunSession& session, const std::function<void(const RunProgress&)>& progress) {
  const std::optional<ExitCode> ended = session.follow(progress, [](const msg::SimStatus&) { return false; });
  return session.wasInterrupted() ? ExitCode::kInterrupted : ended.value_or(ExitCode::kFailed);
}

KilledRun killRun(const Scenario& scenario, const std::optional<Kill>& kill, const std::filesystem::path& folder,
                  RunRequest request) {
  std::vector<ScenarioSetting> settings{{"robot", "./robot.yaml"}};
  // Where nobody is stopped, nobody is to be taken for silent: a busy machine may hold up a process, and starting one
  // takes time.
  if (!kill || kill->of.way != Way::kStopped) settings.emplace_back("late.after_s", "60");
  if (kill && kill->of.way == Way::kRestarted) request.restarts = 1;
  if (kill && kill->of == KillCase{Victim::kRecorder, Way::kKilled}) {
    // What is in its file is up to a second old: with two seconds to the step there is something.
    const double until_s = static_cast<double>(kill->step) * scenario.stepSeconds();
    settings.emplace_back("rate", std::to_string(until_s / 2.0));
  }
  writeFile(folder / "robot.yaml", scenario.robot_text);
  writeFile(folder / "scenario.yaml", editScenario(scenario.text, settings));
  request.scenario = (folder / "scenario.yaml").string();
  request.paused = true;

  RunSession session(request, true);
  KilledRun run;
  {
    const dds::Parting<Killer> killer(session.info(), kill);
    const std::vector<std::string> services = serviceNames(scenario);
    run.exit_code = followToItsEnd(session, [&](const auto&) { killer->resume(services); });
    run.service = killer->service();
    run.step = killer->step();
  }
  if (session.wasInterrupted()) run.exit_code = ExitCode::kInterrupted;  // while it was taken down, too
  run.result = session.result();
  return run;
}

}  // namespace baton
