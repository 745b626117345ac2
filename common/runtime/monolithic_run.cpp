#include "runtime/monolithic_run.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "runtime/admission.hpp"

namespace baton {
namespace {

const Scenario& checked(const Scenario& scenario) {
  if (!scenario.swaps.empty()) {
    throw UsageError(scenario.file + ": expected a scenario without swaps, because in one process there is nobody to " +
                     "hand over to, found one to " + scenario.swaps.front().to);
  }
  if (!scenario.failures.empty()) {
    throw UsageError(scenario.file + ": expected a scenario without failures, because in one process nobody is lost, " +
                     "found one of " + scenario.failures.front().controller);
  }
  if (scenario.mode == SimMode::kRealtime) {
    throw UsageError(scenario.file + ": expected mode lockstep, because in one process nobody can be late, " +
                     "found realtime");
  }
  return scenario;
}

}  // namespace

MonolithicRun::MonolithicRun(const Scenario& scenario)
    : scenario_(checked(scenario)),
      controller_(scenario_.controller(scenario_.active)),
      law_(scenario_, controller_, 0),
      arm_(scenario_.robot, scenario_.armConfig()),
      reference_answer_(scenario_),
      effort_(JointVector::Zero(scenario_.robot.size())),
      buffer_(std::max({dds::maxPayload<msg::PlantState>(), dds::maxPayload<msg::Reference>(),
                        dds::maxPayload<msg::Contact>(), dds::maxPayload<msg::JointCommand>()})) {
  if (scenario_.hasEnvironment()) contact_answer_.emplace(scenario_);
  input_.dt_s = scenario_.stepSeconds();
  prepare(state_message_);
  prepare(reference_message_);
  prepare(command_message_);
}

bool MonolithicRun::step() {
  const bool is_over = scenario_.end_step > 0 && step_ == scenario_.end_step;
  if (is_over || !failure_.empty()) return false;
  const int n = scenario_.robot.size();
  const StepStamp stamp = stampOf(step_, scenario_.step_ns);

  toMessage(stamp, arm_.state(), controller_.name, chain_hash_, state_message_);
  // So says the plant, of which every byte is the same here.
  state_message_.checkpoint(scenario_.hasCheckpointAt(step_));
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
    if (law_.info().uses_force) input_.contact = contact_;
  }

  law_.advance(step_);
  if (const LawStatus status = law_.compute(step_, {.holds = true}, input_, effort_); status != LawStatus::kOk) {
    return fail(controller_.name + " has no effort to give: " + toString(status));
  }
  const std::size_t used = law_.info().uses_force ? 3 : 2;
  toMessage(stamp, controller_.name, effort_, dds::inputsHash(std::span(inputs).first(used)), command_message_);
  hashes.command = hashOf(command_message_);

  if (!arm_.move(effort_, contact_)) {
    return fail(scenario_.lostMotion(contact_.penetration > 0.0));
  }
  chain_hash_ = dds::chainStep(chain_hash_, hashes);
  ++step_;
  return true;
}

bool MonolithicRun::fail(const std::string& reason) {
  failure_ = reason;
  return false;
}

}  // namespace baton
