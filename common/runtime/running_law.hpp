/// A controller's law on its way through a run: which parameters are in force at a step, and whether the law goes on by
/// itself there, takes over, or begins anew. The controller's process runs it on what comes in, `baton whatif` on what
/// was recorded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "control/law.hpp"
#include "control/parameter_schedule.hpp"
#include "runtime/scenario.hpp"

namespace baton {

class RunningLaw {
 public:
  /// What is asked of a controller at a step; nothing of it: that it stands by.
  struct Role {
    bool holds = false;               // PlantState names it
    bool commands_once_more = false;  // the step belongs to the next holder, who blends from it
    bool forgets = false;             // it receives the baton by a hard handover
  };

  /// Keeps references to both. Throws UsageError when the law refuses its parameters.
  /// @param config      one of the scenario's controllers.
  /// @param first_step  the step at which the run begins.
  RunningLaw(const Scenario& scenario, const ControllerConfig& config, std::uint64_t first_step);

  [[nodiscard]] const LawInfo& info() const noexcept { return info_; }
  [[nodiscard]] ParameterSchedule& parameters() noexcept { return parameters_; }
  /// Held the baton at the step computed last.
  [[nodiscard]] bool isActive() const noexcept { return active_; }

  // A step is advance() and then compute() or skip(). None of them allocates.

  /// Parameters that wait for `step` come into force; a process that the scenario has return there has forgotten
  /// everything. True when other parameters are in force.
  bool advance(std::uint64_t step) noexcept;
  /// Its effort for the step. @param[out] effort  n entries [N m or N]; left as it was unless the result is kOk.
  [[nodiscard]] LawStatus compute(std::uint64_t step, const Role& role, const LawInput& input, JointVector& effort);
  /// It stands by and is not asked.
  void skip() noexcept { active_ = false; }

  /// What it would command if it received the baton at this input, by a hard handover or not. Leaves no trace.
  [[nodiscard]] LawStatus tryOut(bool hard, const LawInput& input, JointVector& effort);

  /// What it remembers from step to step.
  void archive(StateArchive& state);
  /// Back to the start of the run.
  void rewind();

 private:
  enum class Start { kContinues, kTakesOver, kForgets };  // of a law at a step: see Law
  [[nodiscard]] LawStatus call(Start start, const LawInput& input, JointVector& effort);

  const LawInfo& info_;
  const std::uint64_t joints_;
  const std::uint64_t first_step_;
  ParameterSchedule parameters_;  // and the laws that are made with them
  bool active_ = false;
  std::vector<std::uint64_t> restarts_;  // steps at which the scenario has it return as a new process
  std::size_t next_restart_ = 0;
  std::vector<std::byte> state_;  // while the law is tried out
};

}  // namespace baton
