#include "runtime/running_law.hpp"

#include <span>

#include "dds/hash.hpp"
#include "msg/checkpoint.h"

namespace baton {

RunningLaw::RunningLaw(const Scenario& scenario, const ControllerConfig& config, std::uint64_t first_step)
    : info_(findLaw(config.law)),
      joints_(static_cast<std::uint64_t>(scenario.robot.size())),
      first_step_(first_step),
      parameters_(info_, scenario.robot, config.parameters, scenario.changesOf(config.name)),
      state_(msg::MAX_CHECKPOINT) {
  for (const PlannedFailure& failure : scenario.failures) {
    const bool is_restart = failure.controller == config.name && failure.restarted;
    // One from before a branch is behind the state that the branch starts from.
    if (is_restart && *failure.returns_at_step >= first_step) restarts_.push_back(*failure.returns_at_step);
  }
}

bool RunningLaw::advance(std::uint64_t step) noexcept {
  const bool has_news = parameters_.advance(step);
  // This process stands for one that had died and was started again: that one would remember nothing.
  for (; next_restart_ < restarts_.size() && restarts_[next_restart_] <= step; ++next_restart_)
    parameters_.law().reset();
  return has_news;
}

LawStatus RunningLaw::compute(std::uint64_t step, const Role& role, const LawInput& input, JointVector& effort) {
  // From the second step with the baton on, a law's state goes on by itself; before, it is asked anew at every step
  // what it would do if it received the baton there. At the start of a run there is nothing to take over.
  const bool continues = role.commands_once_more || (role.holds && (active_ || step == 0));
  const bool forgets = role.holds && role.forgets;
  active_ = role.holds;
  return call(forgets ? Start::kForgets : continues ? Start::kContinues : Start::kTakesOver, input, effort);
}

LawStatus RunningLaw::call(Start start, const LawInput& input, JointVector& effort) {
  Law& law = parameters_.law();
  if (start == Start::kTakesOver) law.handover(input);
  if (start == Start::kForgets) law.reset();
  return law.step(input, effort);
}

LawStatus RunningLaw::tryOut(bool hard, const LawInput& input, JointVector& effort) {
  StateArchive saved = StateArchive::into(state_);
  parameters_.law().archive(saved);
  const LawStatus status = call(hard ? Start::kForgets : Start::kTakesOver, input, effort);
  StateArchive back = StateArchive::from(std::span(state_).first(saved.size()));
  parameters_.law().archive(back);
  return status;
}

void RunningLaw::archive(StateArchive& state) {
  // The state of another law, or of another arm, may have the same length.
  const std::uint64_t own = dds::chainHash(joints_, std::as_bytes(std::span(info_.name)));
  std::uint64_t whose = own;
  state(whose, active_);
  if (whose != own) return state.fail();
  parameters_.archive(state, first_step_);
  parameters_.law().archive(state);
}

void RunningLaw::rewind() {
  parameters_.rewind();
  active_ = false;
  next_restart_ = 0;
}

}  // namespace baton
