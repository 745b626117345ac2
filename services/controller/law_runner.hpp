/// Runs a law: on PlantState(k) and Reference(k), and Contact(k) if the law uses force, its effort for step k. With the
/// baton it goes out as JointCommand(k); standing by, as ShadowCommand(k): the effort it would command if it received
/// the baton at k. PlantState.holder says which, so a handover needs no agreement beyond the state itself.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "parameter_changes.hpp"
#include "runtime/checkpoint.hpp"
#include "runtime/loop_output.hpp"
#include "runtime/running_law.hpp"
#include "runtime/service.hpp"
#include "runtime/status_pace.hpp"
#include "time/step_inputs.hpp"

namespace baton {

class LawRunner {
 public:
  explicit LawRunner(Service& service);

 private:
  enum Input : std::size_t { kState, kReference, kContact };
  template <class T>
  using Window = std::array<T, StepInputs::kWindow>;

  void onState(const msg::PlantState& message, const dds::RawSample& sample);
  void onReference(const msg::Reference& message, const dds::RawSample& sample);
  void onContact(const msg::Contact& message, const dds::RawSample& sample);
  void onPlan(const msg::SwapPlan& plan);
  void arrived(Input input, std::uint64_t step);
  void compute(std::uint64_t step);
  void fill(LawInput& input, std::uint64_t step) const;
  void publish(std::uint64_t step, bool commands);
  void answerForecasts();
  void answer(const msg::SwapPlan& plan);
  void acknowledge(const msg::SwapPlan& plan, bool ready, const JointVector& effort, const char* reason);
  [[nodiscard]] bool isQuiet(std::uint64_t step) const;
  void forget();
  [[nodiscard]] msg::ControllerStatus status() const;
  void publish(const msg::ControllerStatus& status);
  [[nodiscard]] bool isIncoming(const msg::SwapPlan& plan) const;

  Service& service_;
  Checkpoints checkpoint_out_;
  const ControllerConfig& config_;
  RunningLaw law_;
  const LawInfo& info_;
  ParameterChanges parameters_;
  StepInputs inputs_;
  Window<RobotState> states_;
  Window<bool> holds_{};        // whether PlantState named us
  Window<bool> checkpoints_{};  // whether it asked for our state
  Window<Reference> references_;
  Window<Contact> contacts_;
  Window<std::array<std::uint64_t, 3>> hashes_{};  // of the payloads, by input

  LawInput input_;
  JointVector effort_;
  LawStatus last_status_ = LawStatus::kOk;
  std::uint64_t skipped_ = 0;  // steps whose inputs were not complete in time
  bool failing_ = false;       // the last step gave no effort; reported once
  static constexpr std::size_t kMaxOwed = 64;
  std::vector<msg::SwapPlan> owed_;                 // forecasts that wait for their step
  std::optional<std::uint64_t> last_command_step_;  // as outgoing controller: command this step once more
  std::optional<std::uint64_t> fresh_step_;  // as incoming controller of a hard handover: forget everything there
  Window<JointVector> history_;              // efforts of the latest steps

  LoopOutput<msg::JointCommand> command_out_;
  LoopOutput<msg::JointCommand> shadow_out_;
  dds::Writer<msg::SwapAck>& ack_out_;
  dds::Writer<msg::ControllerStatus>& status_out_;
  StatusPace<msg::ControllerStatus> status_pace_;
  msg::JointCommand message_;
  msg::SwapAck ack_;
};

}  // namespace baton
