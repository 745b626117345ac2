/// A scenario in one process: plant, environment, trajectory and law in one loop, without DDS and without a clock. All
/// of them see each other's values through the messages they would have sent, so this loop has the bytes of the
/// distributed system, and the same chain hash. A command that the plant refuses loses its controller the baton, to the
/// fallback or to the brake, as it does there; a controller that has lost it stays away. Nothing else is handed over
/// and nothing is recorded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "control/arm.hpp"
#include "dds/codec.hpp"
#include "dds/hash.hpp"
#include "messages/loop.hpp"
#include "msg/swap.h"
#include "runtime/running_law.hpp"
#include "runtime/scenario.hpp"
#include "runtime/step_answers.hpp"
#include "time/baton_arbiter.hpp"

namespace baton {

class MonolithicRun {
 public:
  /// Throws UsageError for what needs more than one loop: planned handovers, failures, faults and stops, mode realtime.
  /// Controllers that stand by are left out; they change nothing.
  explicit MonolithicRun(const Scenario& scenario);
  MonolithicRun(const MonolithicRun&) = delete;
  MonolithicRun& operator=(const MonolithicRun&) = delete;

  /// Computes the open step and moves the arm. False when there is nothing to compute: the run has reached its end, or
  /// it has failed. Never allocates unless it fails or a controller loses the baton.
  bool step();

  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  /// How many steps are done; the next one is open.
  [[nodiscard]] std::uint64_t steps() const { return step_; }
  /// At the start of the open step.
  [[nodiscard]] const RobotState& state() const { return arm_.state(); }
  // Of the step done last: what the law was given, and what the tip felt.
  [[nodiscard]] const LawInput& input() const { return input_; }
  [[nodiscard]] const Contact& contact() const { return contact_; }
  /// Of all payloads of the loop up to the step before.
  [[nodiscard]] std::uint64_t chainHash() const { return chain_hash_; }
  /// Why the run cannot go on; empty while it can.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// Each time a controller lost the baton, as the plant says it.
  [[nodiscard]] const std::vector<msg::SwapOutcome>& failovers() const { return failovers_; }
  /// The failure, or else who lost the baton first, and why; empty for a run in which all is well.
  [[nodiscard]] std::string whatWentWrong() const;

 private:
  bool fail(const std::string& reason);
  void open();
  [[nodiscard]] std::uint64_t command(int holder, const StepStamp& stamp, const std::array<std::uint64_t, 3>& inputs);
  void takeOver();
  template <class T>
  [[nodiscard]] std::uint64_t hashOf(const T& message) {
    return dds::chainHash(0, dds::encode(message, std::span(buffer_)));
  }

  const Scenario scenario_;
  BatonArbiter arbiter_;
  std::map<int, RunningLaw> laws_;  // of all that can come to hold the baton
  Arm arm_;
  ReferenceAnswer reference_answer_;
  std::optional<ContactAnswer> contact_answer_;

  std::uint64_t step_ = 0;
  std::uint64_t chain_hash_ = 0;
  std::string failure_;
  std::vector<msg::SwapOutcome> failovers_;
  bool keeps_torque_ = false;  // nobody commands the open step
  LawInput input_;
  JointVector effort_;
  Contact contact_;  // zero without an environment
  msg::PlantState state_message_;
  msg::Reference reference_message_;
  msg::Contact contact_message_;
  msg::JointCommand command_message_;
  std::vector<std::byte> buffer_;
};

}  // namespace baton
