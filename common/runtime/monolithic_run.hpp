/// A scenario in one process: plant, environment, trajectory and law in one loop, without DDS and without a clock. All
/// of them see each other's values through the messages they would have sent, so this loop has the bytes of the
/// distributed system, and the same chain hash. Nothing is handed over and nothing is recorded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "control/arm.hpp"
#include "dds/codec.hpp"
#include "dds/hash.hpp"
#include "messages/loop.hpp"
#include "runtime/running_law.hpp"
#include "runtime/scenario.hpp"
#include "runtime/step_answers.hpp"

namespace baton {

class MonolithicRun {
 public:
  /// Throws UsageError for what needs more than one loop: planned handovers and failures, mode realtime. Controllers
  /// that stand by are left out; they change nothing.
  explicit MonolithicRun(const Scenario& scenario);
  MonolithicRun(const MonolithicRun&) = delete;
  MonolithicRun& operator=(const MonolithicRun&) = delete;

  /// Computes the open step and moves the arm. False when there is nothing to compute: the run has reached its end, or
  /// it has failed. Never allocates unless it fails.
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

 private:
  bool fail(const std::string& reason);
  template <class T>
  [[nodiscard]] std::uint64_t hashOf(const T& message) {
    return dds::chainHash(0, dds::encode(message, std::span(buffer_)));
  }

  const Scenario scenario_;
  const ControllerConfig& controller_;
  RunningLaw law_;
  Arm arm_;
  ReferenceAnswer reference_answer_;
  std::optional<ContactAnswer> contact_answer_;

  std::uint64_t step_ = 0;
  std::uint64_t chain_hash_ = 0;
  std::string failure_;
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
