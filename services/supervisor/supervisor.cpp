#include "supervisor.hpp"

#include <signal.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "end_verdict.hpp"
#include "result.hpp"
#include "runtime/log.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {

// How long the others may take. What is still being written is waited for longest: a disk may be slow.
constexpr std::chrono::seconds kStartLimit{60};  // for the processes to find each other
constexpr int kNewsLooks = 30;
constexpr std::chrono::milliseconds kNewsEvery{10};
constexpr std::chrono::seconds kPlantPatience{10};  // to say that the run has ended
constexpr std::chrono::seconds kFilePatience{60};   // for the recorder to close its file
constexpr std::chrono::seconds kStopPatience{3};    // for a process to end

/// Exit codes of a service that say it never got going, as opposed to a death in the middle.
bool isRefusal(const Child::End& end) {
  return !end.by_signal &&
         (end.value == static_cast<int>(ExitCode::kUsage) || end.value == static_cast<int>(ExitCode::kUnavailable));
}

std::string endedInTheMiddle(const std::string& name, const Child::End& end) {
  return name + " ended in the middle of the run: " + end.text();
}

}  // namespace

Supervisor::Supervisor(Service& service, Deployment deployment)
    : service_(service),
      deployment_(std::move(deployment)),
      scenario_(service.scenario()),
      start_limit_(service.executor()),
      patience_(service.executor()),
      sim_out_(service.output(dds::topics::kSimStatus)),
      request_out_(service.output(dds::topics::kSimRequest)),
      launch_out_(service.output(dds::topics::kLaunchReply)) {
  service.answersNoSteps();
  service.onSignal([this] { onSignal(); });
  service.onEnd([this] { runIsOver(); });
  service.onSimStatus([this](const msg::SimStatus& status) { onSimStatus(status); });
  service.input(dds::topics::kTimingStatus, {kPlantName},
                [this](const msg::TimingStatus& status, const dds::RawSample& sample) {
                  if (!service_.participant().isSecondCopy(sample.writer)) timing_ = status;
                });
  service.input(dds::topics::kBatonStatus, {kPlantName},
                [this](const msg::BatonStatus& status, const dds::RawSample& sample) {
                  if (!service_.participant().isSecondCopy(sample.writer)) baton_ = status;
                });
  service.input(dds::topics::kRecorderStatus, withRecorder({}, scenario_),
                [this](const msg::RecorderStatus& status, const dds::RawSample&) { recorder_ = status; });
  service.input(dds::topics::kSwapOutcome, {kPlantName},
                [this](const msg::SwapOutcome& outcome, const dds::RawSample&) {
                  if (!outcome.dry_run()) swaps_.push_back(outcome);
                });
  service.input(dds::topics::kSwapReport, {kPlantName},
                [this](const msg::SwapReport& report, const dds::RawSample&) { reports_.push_back(report); });
  service.input(dds::topics::kLaunchRequest, {},
                [this](const msg::LaunchRequest& request, const dds::RawSample&) { onLaunchRequest(request); });
}

ExitCode Supervisor::run() {
  startAll();
  service_.run();  // what the handlers wrote is ours alone from here on
  considerAbort();
  // A run that was reset is its last take.
  std::erase_if(swaps_, [&](const msg::SwapOutcome& swap) { return swap.take() != sim_.take(); });
  for (const msg::SwapOutcome& swap : swaps_) judge(swap);
  writeResult(deployment_.info, scenario_,
              {.exit_code = exit_code_,
               .reason = reason_,
               .startup_s = startup_s_,
               .sim = lastSimStatus(),
               .timing = timing_,
               .recorder = recorder_,
               .swaps = swaps_,
               .reports = reports_,
               .resident_kB = resident_});
  return exit_code_;
}

/// A run has failed when a handover went otherwise than the scenario says.
void Supervisor::judge(const msg::SwapOutcome& swap) {
  const Scenario& scenario = scenario_;
  const std::string outgoing = swap.outgoing().c_str();
  if (swap.done() && swap.plan_id() == 0 && !scenario.wantsFaultOf(outgoing) && !scenario.plansFailureOf(outgoing)) {
    fail(ExitCode::kFailed, outgoing + " lost the baton: " + swap.reason().c_str());
  }
  for (const PlannedSwap& planned : scenario.swaps) {
    const bool has_come = swap.at_step() < sim_.step();  // else the run ended before
    if (swap.request_id() != 0 || planned.at_step != swap.at_step() || planned.to != swap.incoming().c_str()) continue;
    if (!swap.done() && planned.expect == SwapExpectation::kDone && has_come) {
      fail(ExitCode::kFailed, "a handover that the scenario plans was refused");
    } else if (swap.done() && planned.expect == SwapExpectation::kRefused) {
      fail(ExitCode::kFailed, "a handover took place that the scenario expects to be refused");
    }
  }
}

// --- start
// ------------------------------------------------------------------------------------------------------------

void Supervisor::startAll() {
  const Scenario& scenario = scenario_;
  // Each waits for whom it needs, so any order does. But DDS sends a sample to its readers in the order in which it
  // found them, and for the recorder no step waits.
  if (scenario.hasEnvironment()) start(kEnvironmentName, kEnvironmentName, "");
  start(kTrajectoryName, kTrajectoryName, "");
  for (const ControllerConfig& controller : scenario.controllers) start("controller", controller.name, controller.law);
  start(kPlantName, kPlantName, "");
  if (scenario.recording.enabled) start(kRecorderName, kRecorderName, "");
  limitStart();
}

/// Nobody else notices when a process hangs before the first step: the plant has no step that could be late.
void Supervisor::limitStart() {
  start_limit_.expires_after(kStartLimit);
  start_limit_.async_wait([this](const boost::system::error_code& error) {
    if (error || startup_s_ >= 0.0 || stage_ != Stage::kRunning) return;
    fail(ExitCode::kUnavailable, "the run did not start within " + std::to_string(kStartLimit.count()) +
                                     " s: it waits for " + whatTheStartWaitsFor());
    spdlog::error("{}", reason_);
    runIsOver();
  });
}

std::string Supervisor::whatTheStartWaitsFor() {
  if (const msg::SimStatus sim = lastSimStatus(); sim.waiting_for().size() > 0) return sim.waiting_for().c_str();
  // The plant has said nothing.
  const std::string missing = service_.missing();
  return (missing.empty() ? "the plant" : "the supervisor to find its services over DDS (" + missing + ")") +
         "; see the logs in " + deployment_.info.folder;
}

void Supervisor::start(const std::string& role, const std::string& name, const std::string& law) {
  ServiceOptions options = service_.options();
  options.role = role;
  options.name = name;
  options.law = law;
  options.out = deployment_.info.recording;
  if (role == kRecorderName) options.scheduling = {};  // the loop must not wait for a file
  roles_[name] = role;
  if (!status_out_.contains(name)) status_out_[name] = &service_.output(dds::topics::kServiceStatus);
  // The plant and the recorder have what nobody else knows.
  restarts_left_.try_emplace(name, role == kPlantName || role == kRecorderName ? 0 : deployment_.restarts);
  children_.push_back(std::make_unique<Child>(
      service_.executor(),
      Child::Command{.name = name,
                     .program = siblingProgram("baton-" + role),
                     .arguments = toArguments(options),
                     .log_file = std::filesystem::path(deployment_.info.folder) / (name + ".log")},
      [this](Child& child, const Child::End& end) { childEnded(child, end); }));
  spdlog::info("started service={} pid={}", name, children_.back()->pid());
}

// --- what happens
// -----------------------------------------------------------------------------------------------------

void Supervisor::onSimStatus(const msg::SimStatus& status) {
  sim_ = status;
  const bool has_begun = status.state() != msg::SIM_STATE_STARTING && status.state() != msg::SIM_STATE_ABORTED;
  if (startup_s_ < 0.0 && has_begun) {
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - started_;
    startup_s_ = since.count() - status.elapsed_s();
  }
}

msg::SimStatus Supervisor::lastSimStatus() {
  const std::lock_guard lock(service_.mutex());
  return sim_;
}

msg::BatonStatus Supervisor::lastBatonStatus() {
  const std::lock_guard lock(service_.mutex());
  return baton_;
}

void Supervisor::childEnded(Child& child, const Child::End& end) {
  spdlog::info("ended service={} pid={} {}", child.name(), child.pid(), end.text());
  if (stage_ == Stage::kRunning) {
    judgeWhenBegun(child, end, isRunning(kPlantName) ? kNewsLooks : 0);
  } else {
    endedAfterTheRun(child, end);
  }
  if (!anyRunning()) service_.stop();
}

/// On a busy machine the rest of the run may be over before the death of a part is heard of: it has a name all the
/// same.
void Supervisor::endedAfterTheRun(const Child& child, const Child::End& end) {
  const std::string& name = child.name();
  const bool is_recorder = name == kRecorderName;
  const bool is_expected = asked_to_end_.contains(name) || scenario_.wantsFaultOf(name);
  switch (endVerdict(end, is_recorder, stage_ == Stage::kStopping, has_killed_)) {
    case EndVerdict::kInOrder: break;
    case EndVerdict::kIncomplete: fail(ExitCode::kFailed, "the recording is not complete"); break;
    case EndVerdict::kDied:
      if (!is_expected) fail(ExitCode::kFailed, endedInTheMiddle(name, end));
      break;
  }
  if (is_recorder && stage_ == Stage::kClosingRecording) stopChildren();
}

/// The kernel says at once that a part has ended. That the run had begun comes by DDS, a little later.
void Supervisor::judgeWhenBegun(Child& child, const Child::End& end, int looks) {
  if (startup_s_ >= 0.0 || looks == 0) return childFailed(child, end);
  auto timer = std::make_shared<boost::asio::steady_timer>(service_.executor(), kNewsEvery);
  timer->async_wait([this, timer, &child, end, looks](const boost::system::error_code& error) {
    if (error) return;
    if (stage_ == Stage::kRunning) return judgeWhenBegun(child, end, looks - 1);
    endedAfterTheRun(child, end);
  });
}

void Supervisor::childFailed(Child& child, const Child::End& end) {
  const std::string& name = child.name();
  const bool has_started = startup_s_ >= 0.0;
  const bool is_wanted = asked_to_end_.erase(name) > 0;
  const std::string why = is_wanted ? name + " was stopped" : endedInTheMiddle(name, end);
  service_.event(is_wanted ? msg::SEVERITY_INFO : msg::SEVERITY_ERROR, "child_exit", why);
  const bool is_controller = roles_[name] == "controller";
  const bool is_restarted = has_started && !is_wanted && restarts_left_[name]-- > 0;
  if (has_started && !is_wanted && (is_controller || is_restarted)) {
    spdlog::error("{}", why);
    logLastLines(child.command().log_file, 5);
    if (!scenario_.wantsFaultOf(name)) fail(ExitCode::kFailed, why);
  }
  // Who comes back is waited for like anybody who is late; what the end of the others means, the plant decides.
  if (is_restarted && !is_controller) return restart(name);

  msg::ServiceStatus failed;
  failed.name(name);
  failed.role(roles_[name]);
  failed.state(msg::SERVICE_FAILED);
  failed.pid(child.pid());
  failed.text(is_wanted ? "it was stopped" : end.text());
  {
    const std::lock_guard lock(service_.mutex());
    status_out_.at(name)->write(failed);
  }
  if (is_controller && has_started) {
    // The plant goes on without it: the baton is somebody else's by now.
    if (is_restarted) restart(name);
    return;
  }
  // A refusal has a reason of its own, also when what it refuses was found late.
  const std::string reason = ": " + lastError(child.command().log_file);
  fail(isRefusal(end) ? static_cast<ExitCode>(end.value) : ExitCode::kFailed,
       !has_started ? name + " could not start (" + end.text() + ")" + reason : why + (isRefusal(end) ? reason : ""));
  spdlog::error("{}", reason_);
  logLastLines(child.command().log_file, 5);
  if (name == kPlantName) {
    endForThePlant();
  } else if (!has_started || name == kRecorderName) {
    runIsOver();
  } else {
    enter(Stage::kRunning, kPlantPatience);
  }
}

/// Nobody else would end the run for the others.
void Supervisor::endForThePlant() {
  msg::SimStatus last = lastSimStatus();
  last.state(msg::SIM_STATE_ABORTED);
  last.reason(reason_.substr(0, 199));
  sim_out_.write(last);  // without the lock: our own reader is called from within
  const std::lock_guard lock(service_.mutex());
  sim_ = last;
  service_.runEnded(last.step(), false);
}

/// The first failure names the run's end; what follows from it does not replace it.
void Supervisor::fail(ExitCode code, const std::string& reason) {
  if (exit_code_ == ExitCode::kOk) exit_code_ = code;
  if (reason_.empty()) reason_ = reason;
}

void Supervisor::restart(const std::string& name) {
  try {
    const std::string role = roles_[name];
    start(role, name, role == "controller" ? scenario_.controller(name).law : "");
  } catch (const Error& error) {
    spdlog::error("{} is not started again: {}", name, error.what());
  }
}

void Supervisor::onSignal() {
  if (stage_ != Stage::kRunning) return;  // ending already
  fail(ExitCode::kInterrupted, "stopped from outside");
  spdlog::info("stopping the run");
  for (const auto& child : children_) child->signal(SIGCONT);  // who is stopped could not end anything
  if (!isRunning(kPlantName) || startup_s_ < 0.0) return runIsOver();
  msg::SimRequest request;
  request.request_id(static_cast<std::uint64_t>(getpid()));
  request.action(msg::SIM_STOP);
  {
    const std::lock_guard lock(service_.mutex());
    request_out_.write(request);
  }
  enter(Stage::kRunning, kPlantPatience);
}

// --- the end
// ----------------------------------------------------------------------------------------------------------

void Supervisor::enter(Stage stage, std::chrono::seconds patience) {
  stage_ = stage;
  patience_.expires_after(patience);
  patience_.async_wait([this](const boost::system::error_code& error) {
    if (!error) giveUpWaiting();
  });
}

void Supervisor::giveUpWaiting() {
  switch (stage_) {
    case Stage::kRunning:
      spdlog::warn("the plant does not end the run");
      fail(ExitCode::kAborted, "the plant did not end the run when it was asked to");
      return endForThePlant();
    case Stage::kClosingRecording: spdlog::warn("the recorder does not close its file"); return stopChildren();
    case Stage::kStopping:
      for (const auto& child : children_) {
        if (!child->isRunning() || (child->name() == kRecorderName && !has_spared_recorder_)) continue;
        spdlog::warn("killing service={} pid={}", child->name(), child->pid());
        child->signal(SIGCONT);
        child->signal(SIGKILL);
        has_killed_ = true;
      }
      if (isRunning(kRecorderName) && !std::exchange(has_spared_recorder_, true))
        enter(Stage::kStopping, kFilePatience);
      return;
  }
}

/// At the first word of the end, before what follows from it; and at the last, in case the first was another.
void Supervisor::considerAbort() {
  const msg::SimStatus last = lastSimStatus();
  if (last.state() == msg::SIM_STATE_ABORTED) fail(ExitCode::kAborted, last.reason().c_str());
}

void Supervisor::runIsOver() {
  if (stage_ != Stage::kRunning) return;
  considerAbort();
  for (const auto& child : children_) {
    if (child->isRunning()) resident_[child->name()] = child->residentKilobytes();
    if (child->name() == kRecorderName) child->signal(SIGCONT);  // nobody notices in real time that it is stopped
  }
  // A run that never started has nobody who would end it: the recorder is told like everybody else.
  if (isRunning(kRecorderName) && startup_s_ >= 0.0) {
    enter(Stage::kClosingRecording, kFilePatience);
  } else {
    stopChildren();
  }
}

void Supervisor::stopChildren() {
  enter(Stage::kStopping, kStopPatience);
  for (const auto& child : children_) child->signal(SIGTERM);
  if (!anyRunning()) service_.stop();
}

bool Supervisor::anyRunning() const {
  return std::any_of(children_.begin(), children_.end(), [](const auto& child) { return child->isRunning(); });
}

bool Supervisor::isRunning(const std::string& name) const {
  return std::any_of(children_.begin(), children_.end(),
                     [&](const auto& child) { return child->name() == name && child->isRunning(); });
}

}  // namespace baton
