/// The plant as a service. Each step: publish PlantState(k), take Contact(k) and the holder's JointCommand(k), move the
/// arm, open k + 1. In lockstep the last input to arrive moves the arm, in DDS's receive thread; in realtime a timer
/// does. The rules are in time/ (StepMaster, BatonArbiter, Pacer); this is their wiring.
#pragma once

#include <array>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "control/arm.hpp"
#include "control/handover_meter.hpp"
#include "failure_script.hpp"
#include "runtime/baton_rules.hpp"
#include "runtime/checkpoint.hpp"
#include "runtime/loop_output.hpp"
#include "runtime/service.hpp"
#include "runtime/status_pace.hpp"
#include "step_timing.hpp"
#include "time/baton_arbiter.hpp"
#include "time/dry_runs.hpp"
#include "time/pacer.hpp"
#include "time/step_master.hpp"

namespace baton {

class Plant {
 public:
  explicit Plant(Service& service);

  /// What a run needs of the plant to go on from a quiet step.
  void archive(StateArchive& state);

 private:
  // What arrives, under the service's lock.
  void onContact(const msg::Contact& message, const dds::RawSample& sample);
  void onCommand(const msg::JointCommand& message, const dds::RawSample& sample);
  void onSimRequest(const msg::SimRequest& request);
  void onSwapRequest(const msg::SwapRequest& message);
  void onSwapAck(const msg::SwapAck& ack, const dds::RawSample& sample);
  void onControllerStatus(const msg::ControllerStatus& status, const dds::RawSample& sample);
  void onRewindAck(const msg::RewindAck& ack);
  void onServiceStatus(const msg::ServiceStatus& status, const dds::RawSample& sample);
  void onBadInput(std::uint64_t step, const std::string& text);
  void endAtBadInput();

  // The run.
  void startWhenAllAreReady();
  void proceed();     // lockstep: end every step that may end
  void tick();        // realtime: end the step because its time is over
  void keepTorque();  // nobody commands the open step: the joints feel what they felt before
  void endStep();     // move the arm over the open step and open the next
  void openStep();    // publish the state of the step that has just opened
  void askAgain();    // publish it once more, for who was not there
  void finish();
  // plant_rewind.cpp: back to the first step
  void askForReset(std::uint64_t request_id);
  void prepareReset();
  void publishRewind(msg::RewindPhase phase);
  void resetAcknowledged(const std::string& name);
  void finishReset();
  void giveUpReset();
  void dropReset(const std::string& reason);
  void abort(const std::string& reason);
  void newcomerStandsBy(const msg::ControllerStatus& status, const dds::RawSample& sample);
  void resumeFromCheckpoint();
  // plant_failures.cpp: who is lost, who comes back, and what else a re-run has to know
  void memberLost(int member, const char* reason);
  void memberFound(int member);
  void takeForFailed(int member, const char* reason);
  void decideFailure(int member, const char* reason);
  void letReturn(int member);
  [[nodiscard]] std::vector<int> absentAtBegin();
  void failAsPlanned();                 // what the scenario plans for the step that has just opened
  void commandedAsPlanned(int member);  // the command of a member that fails behind it is here
  void stopAsPlanned();
  [[nodiscard]] bool stopAt(std::uint64_t step);
  void decideEnd(std::uint64_t step);
  [[nodiscard]] msg::Decision decisionOf(msg::DecisionCause cause, int member) const;
  // plant_baton.cpp: handovers
  void scheduleSwaps();
  void archiveScheduled(StateArchive& state);
  void planSwaps();
  void refuseScheduled(const char* reason);
  void considerSwap();
  void onDryRun(const HandoverRequest& request, const char* target);
  void dryRunsKnowStep();
  void publishDryRuns();
  void publishSwapActions();
  void decideSwap(const HandoverPlan& plan);
  void publishPlan(const HandoverPlan& plan, std::uint64_t id, msg::SwapPhase phase);
  void publishRefusal(const HandoverPlan& plan, const char* reason);
  void publishDone(const HandoverPlan& plan, const char* reason, const JointVector& raw_step,
                   const JointVector& applied_step);
  void publishDryRun(const DryRun& dry_run);
  void publishBaton();
  [[nodiscard]] msg::SwapOutcome outcomeOf(const HandoverPlan& plan, const char* reason) const;
  /// The first step of a new holder: what its torque lacks of the old one's begins to fade.
  [[nodiscard]] JointVector takeOver(std::uint64_t step);
  void measureStep(std::uint64_t step, const JointVector& tau_before, const JointVector& q_before);
  void publishReport(bool cut_short);
  // plant_outputs.cpp
  [[nodiscard]] msg::SimStatus status() const;
  void publish(const msg::SimStatus& status);
  void repeatStatus();
  void armTimer();
  void watchLateness();

  [[nodiscard]] std::string namesWaitedFor() const;
  [[nodiscard]] int memberCalled(std::string_view name) const;
  [[nodiscard]] bool speaksFor(int member, const dds::RawSample& sample) const;
  [[nodiscard]] std::string holderText() const;
  [[nodiscard]] bool isRealtime() const { return scenario_.mode == SimMode::kRealtime; }
  [[nodiscard]] static std::int64_t steadyNow();

  Service& service_;
  const Scenario& scenario_;
  Checkpoints checkpoints_;
  Arm arm_;
  StepMaster master_;
  BatonArbiter arbiter_;
  DryRuns dry_runs_;
  HandoverMeter meter_;
  Pacer pacer_;
  boost::asio::steady_timer timer_;

  // inputs of the open step
  Contact contact_;
  JointVector effort_;           // the holder's
  JointVector outgoing_effort_;  // at the first step of a handover
  dds::StepHashes hashes_;
  std::uint64_t chain_hash_ = 0;  // of the steps before

  /// The process that speaks for a controller: the first to say that it is ready, until it fails.
  struct Speaker {
    dds::GuidPrefix prefix{};
    std::int32_t pid = 0;  // 0: none yet
  };
  struct Refusal {
    std::uint64_t step = 0;
    ReasonText reason{};  // empty: none
  };
  /// A controller, by the arbiter's number. The arbiter takes it for failed as long as it is lost, for either cause.
  struct Member {
    Speaker speaker;
    Speaker successor;                  // ready before its predecessor was known to have failed
    Refusal refusal;                    // the last one
    ReasonText ails{};                  // why its law has no effort to give, by its latest status; empty: nothing
    bool is_lost = false;               // gone, silent, or talking nonsense
    bool is_new = false;                // since it was lost: another process
    bool is_lost_as_planned = false;    // the scenario says so
    bool fails_when_commanded = false;  // the same, once its command for the open step is here
  };
  static void becomes(Member& member, const Speaker& speaker);
  std::vector<Member> members_;
  std::map<std::string, Speaker, std::less<>> newcomers_;  // ready controllers that are no members yet
  FailureScript failure_script_;
  std::size_t next_stop_ = 0;  // of those that the scenario plans
  static constexpr const char* kPlannedFailure = "the scenario plans it";

  /// A reset that has been asked for.
  struct Reset {
    std::uint64_t request_id = 0;
    std::int64_t asked_ns = 0;
    std::optional<msg::RewindPhase> phase;          // none: the open step is not complete yet
    std::set<std::string, std::less<>> waited_for;  // services that have not acknowledged the phase
  };
  std::optional<Reset> reset_;
  std::uint32_t take_ = 0;       // of the run; larger behind each reset
  std::uint32_t next_take_ = 1;  // of the next attempt at a reset
  bool has_recorder_failed_ = false;
  /// A sample that no service can use: the run ends at its step, which nothing can complete.
  struct BadInput {
    std::uint64_t step = 0;
    std::string text;
  };
  std::optional<BadInput> bad_input_;

  std::set<std::string, std::less<>> waited_for_;  // services not ready yet
  std::optional<HandoverPlan> completed_;          // took effect at the open step: its outcome follows the motion
  ReasonText completed_reason_{};
  std::uint64_t metered_plan_ = 0;                  // whose effect the meter measures
  static constexpr std::size_t kMaxScheduled = 64;  // asked for by operators, besides those of the scenario
  std::vector<HandoverRequest> scheduled_;          // handovers for later steps
  bool keeps_torque_ = false;                       // for the open step
  StepTiming timing_;
  std::uint64_t missed_in_a_row_ = 0;
  std::uint64_t silent_in_a_row_ = 0;  // of them, those where the holder had what it needs
  std::uint64_t missed_ = 0;
  const std::int64_t made_ns_ = steadyNow();
  std::int64_t started_ns_ = 0;
  std::int64_t ended_ns_ = 0;
  std::int64_t progress_ns_ = 0;  // when the open step opened
  static constexpr std::uint64_t kNever = ~std::uint64_t{0};
  std::uint64_t warned_step_ = kNever;
  std::string end_reason_;

  LoopOutput<msg::PlantState> state_out_;
  dds::Writer<msg::PlantState>& again_out_;
  dds::Writer<msg::SimReply>& reply_out_;
  dds::Writer<msg::SimStatus>& status_out_;
  StatusPace<msg::SimStatus> status_pace_;
  dds::Writer<msg::Rewind>& rewind_out_;
  dds::Writer<msg::TimingStatus>& timing_out_;
  dds::Writer<msg::SwapPlan>& plan_out_;
  dds::Writer<msg::SwapOutcome>& outcome_out_;
  dds::Writer<msg::SwapReport>& report_out_;
  dds::Writer<msg::BatonStatus>& baton_out_;
  dds::Writer<msg::Decision>& decision_out_;
  msg::PlantState state_message_;
};

}  // namespace baton
