#include "runtime/monolithic_run.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "runtime/admission.hpp"
#include "runtime/baton_rules.hpp"

namespace baton {
namespace {

const Scenario& checked(const Scenario& scenario) {
  const auto refuse = [&](const std::string& expected, const std::string& found) {
    throw UsageError(scenario.file + ": in one process expected " + expected + ", found " + found +
                     "; run it as processes, without --in-process");
  };
  if (!scenario.swaps.empty()) {
    refuse("a scenario without swaps, because there is nobody to hand over to", "one to " + scenario.swaps.front().to);
  }
  if (!scenario.failures.empty()) {
    refuse("a scenario without failures, because nobody is lost", "one of " + scenario.failures.front().controller);
  }
  if (!scenario.faults.empty()) {
    const Fault& first = scenario.faults.front();
    refuse("a scenario without faults, because no message is sent and no process can end",
           std::string(toString(first.kind)) + " of " + first.service);
  }
  if (!scenario.stops.empty()) {
    refuse("a scenario without stops, because nobody asks for one",
           "one at step " + std::to_string(scenario.stops.front().at_step));
  }
  if (scenario.mode == SimMode::kRealtime) refuse("mode lockstep, because nobody can be late", "realtime");
  return scenario;
}

}  // namespace

MonolithicRun::MonolithicRun(const Scenario& scenario)
    : scenario_(checked(scenario)),
      arbiter_(arbiterConfig(scenario_)),
      arm_(scenario_.robot, scenario_.armConfig()),
      reference_answer_(scenario_),
      effort_(JointVector::Zero(scenario_.robot.size())),
      buffer_(std::max({dds::maxPayload<msg::PlantState>(), dds::maxPayload<msg::Reference>(),
                        dds::maxPayload<msg::Contact>(), dds::maxPayload<msg::JointCommand>()})) {
  const ArbiterConfig baton = arbiterConfig(scenario_);
  std::vector<int> holders = baton.fallback;
  holders.push_back(baton.holder);
  for (const int holder : holders) {
    laws_.try_emplace(holder, scenario_, scenario_.controllers[static_cast<std::size_t>(holder)], 0);
  }
  if (scenario_.hasEnvironment()) contact_answer_.emplace(scenario_);
  input_.dt_s = scenario_.stepSeconds();
  prepare(state_message_);
  prepare(reference_message_);
  prepare(command_message_);
  open();
}

/// Who holds the baton at the step that has just opened.
void MonolithicRun::open() {
  const int before = arbiter_.holder();
  const int holder = arbiter_.open(step_);
  while (const std::optional<ArbiterAction> action = arbiter_.takeAction()) {
    msg::SwapOutcome& outcome = failovers_.emplace_back();
    outcome.done(true);
    outcome.outgoing(arbiter_.nameOf(before));
    outcome.incoming(arbiter_.nameOf(holder));
    outcome.decided_at_step(action->plan.decided_at_step);
    outcome.at_step(action->plan.at_step);
    outcome.blend_steps(action->plan.blend_steps);
    outcome.reason(action->reason.data());
  }
}

bool MonolithicRun::step() {
  const bool is_over = scenario_.end_step > 0 && step_ == scenario_.end_step;
  if (is_over || !failure_.empty()) return false;
  const int n = scenario_.robot.size();
  const StepStamp stamp = stampOf(step_, scenario_.step_ns);
  const int holder = arbiter_.holder();

  toMessage(stamp, arm_.state(), arbiter_.nameOf(holder), chain_hash_, state_message_);
  // So says the plant, of which every byte is the same here.
  state_message_.checkpoint(scenario_.hasCheckpointAt(step_) && arbiter_.isQuiet(step_));
  reference_answer_(step_, reference_message_);
  if (const Reading reading = fromMessage(state_message_, n, input_.state); !reading) {
    return fail(badInputText(dds::topics::kPlantState.name, step_, reading.text()));
  }
  if (const Reading reading = fromMessage(reference_message_, n, input_.reference); !reading) {
    return fail(badInputText(dds::topics::kReference.name, step_, reading.text()));
  }
  std::array<std::uint64_t, 3> inputs{hashOf(state_message_), hashOf(reference_message_), 0};
  dds::StepHashes hashes{.state = inputs[0]};

  if (contact_answer_) {
    (void)(*contact_answer_)(state_message_, contact_message_);  // the state has been read above
    if (const Reading reading = fromMessage(contact_message_, contact_); !reading) {
      return fail(badInputText(dds::topics::kContact.name, step_, reading.text()));
    }
    hashes.contact = inputs[2] = hashOf(contact_message_);
  }

  for (auto& [member, law] : laws_) law.advance(step_);
  keeps_torque_ = false;
  if (holder == kBrake) {
    effort_ = arm_.brakeEffort();
  } else {
    hashes.command = command(holder, stamp, inputs);
  }
  arbiter_.consider(step_, effort_, contact_.penetration > 0.0);
  const JointVector tau_before = arm_.state().tau_applied;
  if (arbiter_.changedAt(step_)) takeOver();
  const JointVector tau = arm_.blended(step_, effort_);
  if (!arm_.move(tau, contact_)) return fail(scenario_.lostMotion(contact_, Arm(arm_).move(tau, {})));
  if (arbiter_.changedAt(step_)) {
    assignSequence(arm_.state().tau_applied - tau_before, failovers_.back().applied_effort_step());
  }
  chain_hash_ = dds::chainStep(chain_hash_, hashes);
  ++step_;
  open();
  return true;
}

/// The holder's command and what the plant makes of it. Returns its hash.
std::uint64_t MonolithicRun::command(int holder, const StepStamp& stamp, const std::array<std::uint64_t, 3>& inputs) {
  RunningLaw& law = laws_.at(holder);
  const bool uses_force = law.info().uses_force;
  input_.contact = uses_force ? contact_ : Contact{};
  const LawStatus status = law.compute(step_, {.holds = true}, input_, effort_);
  const bool has_effort = status == LawStatus::kOk;
  toMessage(stamp, arbiter_.nameOf(holder), has_effort ? effort_ : JointVector(),
            dds::inputsHash(std::span(inputs).first(uses_force ? 3 : 2)), command_message_);
  const ReasonText objection = objectionTo(command_message_, scenario_, has_effort ? "" : toString(status), effort_);
  if (objection.front() != '\0') {
    effort_ = arm_.holdingEffort(step_);
    keeps_torque_ = true;
    arbiter_.memberFailed(holder, step_, objection.data());
  }
  return hashOf(command_message_);
}

/// The next holder's effort is blended from what the joints felt before.
void MonolithicRun::takeOver() {
  const JointVector raw_step = arm_.state().tau_applied - effort_;
  arm_.blendFrom(step_, scenario_.baton.blend_steps, raw_step);
  if (keeps_torque_) effort_ = arm_.holdingEffort(step_);
  assignSequence(raw_step, failovers_.back().raw_effort_step());
}

bool MonolithicRun::fail(const std::string& reason) {
  failure_ = reason;
  return false;
}

std::string MonolithicRun::whatWentWrong() const {
  if (!failure_.empty() || failovers_.empty()) return failure_;
  return std::string(failovers_.front().outgoing().c_str()) + " lost the baton: " + failovers_.front().reason().c_str();
}

}  // namespace baton
