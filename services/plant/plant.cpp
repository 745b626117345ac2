#include "plant.hpp"

#include <algorithm>

namespace baton {
namespace {

StepMasterConfig masterConfig(const Scenario& scenario, std::uint64_t first_step) {
  const bool has_credit = scenario.recording.enabled && scenario.mode == SimMode::kLockstep;
  return {.first_step = first_step,
          .end_step = scenario.end_step,
          .needs_contact = scenario.hasEnvironment(),
          .credit = has_credit ? scenario.recording.credit_steps : 0};
}

}  // namespace

Plant::Plant(Service& service)
    : service_(service),
      scenario_(service.scenario()),
      checkpoints_(service),
      arm_(scenario_.robot, scenario_.armConfig()),
      master_(masterConfig(scenario_, checkpoints_.firstStep())),
      arbiter_(arbiterConfig(scenario_)),
      dry_runs_(arbiter_),
      meter_(scenario_.stepSeconds(), scenario_.baton.max_effort_rate),
      pacer_(scenario_.step_ns, scenario_.rate),
      timer_(service.executor()),
      effort_(JointVector::Zero(scenario_.robot.size())),
      outgoing_effort_(effort_),
      members_(scenario_.controllers.size()),
      failure_script_(scenario_.failures, controllerNames(scenario_)),
      state_out_(service, dds::topics::kPlantState, servicesBut(kPlantName, scenario_)),
      again_out_(service.output(dds::topics::kPlantStateAgain)),
      reply_out_(service.output(dds::topics::kSimReply)),
      status_out_(service.output(dds::topics::kSimStatus,
                                 withSupervisor(servicesBut(kPlantName, scenario_), service.options()))),
      // Nobody is required to take part in resets: a controller of somebody else may not. Who does waits for us.
      rewind_out_(service.output(dds::topics::kRewind)),
      timing_out_(service.output(dds::topics::kTimingStatus, withSupervisor({}, service.options()))),
      plan_out_(service.output(dds::topics::kSwapPlan, withRecorder(controllerNames(scenario_), scenario_))),
      outcome_out_(
          service.output(dds::topics::kSwapOutcome, withSupervisor(withRecorder({}, scenario_), service.options()))),
      report_out_(
          service.output(dds::topics::kSwapReport, withSupervisor(withRecorder({}, scenario_), service.options()))),
      baton_out_(service.output(dds::topics::kBatonStatus, withSupervisor({}, service.options()))),
      decision_out_(service.output(dds::topics::kDecision, withRecorder({}, scenario_))) {
  prepare(state_message_);
  // Of these the supervisor makes the run's result.
  for (dds::RawWriter* const writer : {&timing_out_.raw(), &baton_out_.raw(), &outcome_out_.raw(), &report_out_.raw()})
    service.leavesAfter(*writer);
  scheduled_.reserve(scenario_.swaps.size() + kMaxScheduled);
  scheduleSwaps();
  for (std::string& name : withSupervisor(servicesBut(kPlantName, scenario_), service.options()))
    waited_for_.insert(std::move(name));
  resumeFromCheckpoint();

  if (scenario_.hasEnvironment()) {
    service.input(dds::topics::kContact, {kEnvironmentName},
                  [this](const msg::Contact& message, const dds::RawSample& sample) { onContact(message, sample); });
  }
  service.input(dds::topics::kJointCommand, controllerNames(scenario_),
                [this](const msg::JointCommand& message, const dds::RawSample& sample) { onCommand(message, sample); });
  service.input(dds::topics::kSwapAck, controllerNames(scenario_),
                [this](const msg::SwapAck& ack, const dds::RawSample& sample) { onSwapAck(ack, sample); });
  service.input(dds::topics::kControllerStatus, {},
                [this](const msg::ControllerStatus& status, const dds::RawSample& sample) {
                  onControllerStatus(status, sample);
                });
  service.input(
      dds::topics::kServiceStatus, withSupervisor(servicesBut(kPlantName, scenario_), service.options()),
      [this](const msg::ServiceStatus& status, const dds::RawSample& sample) { onServiceStatus(status, sample); });
  service.input(dds::topics::kSimRequest, {},
                [this](const msg::SimRequest& request, const dds::RawSample&) { onSimRequest(request); });
  service.input(dds::topics::kSwapRequest, {},
                [this](const msg::SwapRequest& request, const dds::RawSample&) { onSwapRequest(request); });
  if (scenario_.recording.enabled) {
    service.input(dds::topics::kRecorderStatus, {kRecorderName},
                  [this](const msg::RecorderStatus& status, const dds::RawSample&) {
                    has_recorder_failed_ = status.state() == msg::RECORDER_FAILED;
                    if (status.take() != take_ && !has_recorder_failed_) return;
                    master_.recorderAcknowledged(status.acknowledged_step());
                    proceed();
                  });
  }
  service.input(dds::topics::kRewindAck, {}, [this](const msg::RewindAck& ack, const dds::RawSample& sample) {
    if (service_.admission().speaksFor(sample.writer, ack.name().c_str())) onRewindAck(ack);
  });
  service.onReady([this] {
    const std::lock_guard lock(service_.mutex());
    startWhenAllAreReady();
  });
  service.every(std::chrono::milliseconds(100), [this] {
    const std::lock_guard lock(service_.mutex());
    repeatStatus();
    watchLateness();
  });
}

std::int64_t Plant::steadyNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

int Plant::memberCalled(std::string_view name) const {
  const auto& members = arbiter_.members();
  const auto found =
      std::find_if(members.begin(), members.end(), [&](const ArbiterMember& m) { return m.name == name; });
  return found == members.end() ? kBrake : static_cast<int>(found - members.begin());
}

std::string Plant::holderText() const {
  const std::string& name = arbiter_.nameOf(arbiter_.holder());
  return name.empty() ? "the brake" : name;
}

bool Plant::speaksFor(int member, const dds::RawSample& sample) const {
  return member != kBrake && dds::prefixOf(sample.writer) == members_[static_cast<std::size_t>(member)].speaker.prefix;
}

void Plant::startWhenAllAreReady() {
  if (master_.phase() != SimPhase::kStarting || !service_.isReady() || !waited_for_.empty()) return;
  master_.start();
  started_ns_ = steadyNow();
  pacer_.anchor(master_.step(), started_ns_);
  warned_step_ = kNever;
  for (const int member : absentAtBegin()) {
    arbiter_.memberFailed(member, master_.step(), "it had failed before the first step");
  }
  arbiter_.open(master_.step());
  service_.event(msg::SEVERITY_INFO, "start", holderText() + " holds the baton");
  if (service_.options().starts_paused) master_.pause();
  openStep();
  publish(status());
  publishBaton();
  if (isRealtime()) {
    armTimer();
  } else {
    proceed();
  }
}

void Plant::openStep() {
  const std::uint64_t step = master_.step();
  service_.at(step);
  progress_ns_ = steadyNow();
  timing_.opened(progress_ns_, master_.phase() != SimPhase::kPaused);
  keeps_torque_ = false;
  hashes_ = {};
  master_.needOutgoing(arbiter_.outgoingAt(step) != kBrake);
  toMessage(service_.stampOf(step), arm_.state(), arbiter_.nameOf(arbiter_.holder()), chain_hash_, state_message_);
  const bool has_checkpoint = scenario_.hasCheckpointAt(step) && arbiter_.isQuiet(step) && !completed_;
  if (has_checkpoint) checkpoints_.save(step, *this);
  state_message_.checkpoint(has_checkpoint);
  state_out_.write(state_message_);
  hashes_.state = dds::chainHash(0, state_out_.payload());
  if (arbiter_.holder() == kBrake) {
    effort_ = arm_.brakeEffort();
    master_.commandArrived(step);
  }
  if (!master_.isOver()) {
    stopAsPlanned();
    failAsPlanned();
  }
  planSwaps();
}

void Plant::askAgain() {
  if (master_.phase() == SimPhase::kStarting || master_.isOver()) return;
  again_out_.write(state_message_);
}

void Plant::resumeFromCheckpoint() {
  if (!checkpoints_.restore(*this)) return;
  // What the scenario plans for earlier has been asked for already; see planSwaps().
  const std::uint64_t earliest = checkpoints_.firstStep() + scenario_.baton.margin_steps + 1;
  std::erase_if(scheduled_, [&](const HandoverRequest& request) { return request.at_step < earliest; });
}

void Plant::archive(StateArchive& state) {
  arm_.archive(state);
  arbiter_.archive(state);
  state(chain_hash_, missed_, missed_in_a_row_, silent_in_a_row_, metered_plan_);
  meter_.archive(state);
  archiveScheduled(state);
}

void Plant::keepTorque() {
  effort_ = arm_.holdingEffort(master_.step());
  keeps_torque_ = true;
}

void Plant::proceed() {
  if (isRealtime()) {
    considerSwap();
    return prepareReset();
  }
  for (;;) {
    considerSwap();
    prepareReset();
    if (master_.hold() != Hold::kNone) return;
    constexpr std::int64_t kCatchUp_ns = 100'000'000;  // what a busy machine may cost; more is a stall
    const std::int64_t now_ns = steadyNow();
    if (!pacer_.isDue(master_.step() + 1, now_ns)) return armTimer();
    pacer_.forgive(master_.step() + 1, now_ns, kCatchUp_ns);
    endStep();
    if (arbiter_.holder() == kBrake && !scenario_.hasEnvironment()) {
      // Nobody has to answer: the steps would follow each other for ever in this call. Others get their turn in
      // between.
      boost::asio::post(service_.executor(), [this] {
        const std::lock_guard lock(service_.mutex());
        proceed();
      });
      return;
    }
  }
}

void Plant::tick() {
  if (master_.phase() != SimPhase::kRunning) return;
  const std::int64_t now_ns = steadyNow();
  const std::optional<std::int64_t> due_ns = pacer_.deadline(master_.step() + 1);
  // A timer that was armed anew may have been on its way already.
  if (due_ns && now_ns < *due_ns) return armTimer();
  considerSwap();
  prepareReset();
  if (reset_ && reset_->phase) return;  // whoever ends the reset arms the timer again
  for (int member = 0; member < static_cast<int>(members_.size()); ++member) commandedAsPlanned(member);  // or never
  const Hold missing = master_.inputsHold();
  if (missing == Hold::kNone) {
    missed_in_a_row_ = silent_in_a_row_ = 0;
  } else {
    ++missed_;
    if (!master_.hasCommand() && missing != Hold::kContact) ++silent_in_a_row_;
    const bool give_up = ++missed_in_a_row_ > scenario_.max_missed_steps;
    if (give_up) {
      effort_ = arm_.brakeEffort();
    } else if (!master_.hasCommand()) {
      keepTorque();
    }
    if (silent_in_a_row_ > scenario_.max_missed_steps) {
      const int silent = arbiter_.holder();
      service_.event(msg::SEVERITY_ERROR, "missed", arbiter_.nameOf(silent) + " was silent for too many steps");
      Member& one = members_[static_cast<std::size_t>(silent)];
      one.is_lost = true;
      one.is_new = false;
      decideFailure(silent, "it was silent for too many steps");
      dry_runs_.memberFailed(silent);
      publishDryRuns();
      missed_in_a_row_ = silent_in_a_row_ = 0;  // counted anew for whoever is next
    } else if (missed_in_a_row_ == scenario_.max_missed_steps + 1) {
      service_.event(msg::SEVERITY_WARNING, "missed",
                     "the environment is silent: the brake holds until it speaks again");
    }
  }
  timing_.ticked(now_ns - due_ns.value_or(now_ns), keeps_torque_);
  endStep();
  armTimer();
}

void Plant::endStep() {
  const std::uint64_t step = master_.step();
  const JointVector tau_before = arm_.state().tau_applied;
  const JointVector q_before = arm_.state().q;
  dryRunsKnowStep();
  // A new holder that is late for its first step (realtime) takes over with its first command.
  const bool takes_over = completed_ && master_.hasCommand();
  const JointVector raw_step = takes_over ? takeOver(step) : JointVector();
  if (takes_over && keeps_torque_) effort_ = arm_.holdingEffort(step);  // the blend it reckoned with is gone
  const JointVector tau = arm_.blended(step, effort_);
  if (!arm_.move(tau, contact_)) return abort(scenario_.lostMotion(contact_, Arm(arm_).move(tau, {})));
  chain_hash_ = dds::chainStep(chain_hash_, hashes_);
  if (takes_over) {
    completed_->at_step = step;
    publishDone(*completed_, completed_reason_.data(), raw_step, arm_.state().tau_applied - tau_before);
    completed_.reset();
  }
  measureStep(step, tau_before, q_before);
  service_.stepDone(step);
  master_.advance();
  service_.at(master_.step());
  arbiter_.open(master_.step());
  publishSwapActions();
  openStep();
  if (master_.isOver()) {
    end_reason_ = "reached its end";
    return finish();
  }
  endAtBadInput();
}

void Plant::finish() {
  ended_ns_ = steadyNow();
  arbiter_.runEnded();
  publishSwapActions();
  if (completed_) {
    const char* failure = completed_reason_.data();
    publishDone(*completed_, *failure != '\0' ? failure : "the run ended before its first step did", {}, {});
    completed_.reset();
  }
  publishReport(true);
  dry_runs_.dropAll("the run has ended");
  publishDryRuns();
  refuseScheduled("the run has ended");
  if (reset_) dropReset("the run has ended");
  publish(status());
  service_.stepDone(master_.step());
  service_.runEnded(master_.step(), true);
}

void Plant::abort(const std::string& reason) {
  if (master_.isOver()) return;
  end_reason_ = reason;
  service_.event(msg::SEVERITY_ERROR, "abort", reason);
  master_.abort();
  finish();
}

void Plant::armTimer() {
  const std::optional<std::int64_t> due = pacer_.deadline(master_.step() + 1);
  if (!due || master_.phase() != SimPhase::kRunning) return;
  boost::asio::post(service_.executor(), [this, due] {
    timer_.expires_at(std::chrono::steady_clock::time_point(std::chrono::nanoseconds(*due)));
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      const std::lock_guard lock(service_.mutex());
      if (isRealtime()) {
        tick();
      } else {
        proceed();
      }
    });
  });
}

void Plant::watchLateness() {
  const Hold hold = master_.hold();
  constexpr double kStartWarnAfter_s = 5.0;
  if (hold == Hold::kNotStarted) {
    const double waiting_s = static_cast<double>(steadyNow() - made_ns_) * 1e-9;
    if (waiting_s > kStartWarnAfter_s && warned_step_ != master_.step()) {
      warned_step_ = master_.step();
      service_.event(msg::SEVERITY_WARNING, "late", "the start waits for " + namesWaitedFor());
    }
    return;
  }
  if (reset_) {
    constexpr double kResetPatience_s = 10.0;
    if (static_cast<double>(steadyNow() - reset_->asked_ns) * 1e-9 > kResetPatience_s) return giveUpReset();
  }
  if (hold == Hold::kRewind) return;
  const bool someone_is_late = hold == Hold::kContact || hold == Hold::kCommand || hold == Hold::kHandover ||
                               hold == Hold::kSwap || hold == Hold::kRecorder;
  if (!someone_is_late) {
    progress_ns_ = steadyNow();
    return;
  }
  const double late_s = static_cast<double>(steadyNow() - progress_ns_) * 1e-9;
  const std::string who = toString(hold);
  if (late_s > scenario_.late_after_s && scenario_.late_policy != LatePolicy::kWait) {
    const int member = hold == Hold::kCommand    ? arbiter_.holder()
                       : hold == Hold::kHandover ? arbiter_.outgoingAt(master_.step())
                       : hold == Hold::kSwap     ? arbiter_.awaitedMember(master_.step())
                                                 : kBrake;
    if (scenario_.late_policy == LatePolicy::kAbort || member == kBrake) {
      return abort("the step waits for " + who + ", too long");
    }
    service_.event(msg::SEVERITY_ERROR, "late", arbiter_.nameOf(member) + " is silent: it is taken for failed");
    memberLost(member, "it was silent for too long");
    return proceed();
  }
  constexpr double kWarnAfter_s = 1.0;
  if (late_s < kWarnAfter_s) return;
  askAgain();
  if (warned_step_ != master_.step()) {
    warned_step_ = master_.step();
    service_.event(msg::SEVERITY_WARNING, "late", "the step waits for " + who);
  }
}

}  // namespace baton
