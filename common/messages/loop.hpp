/// The loop's signals to messages and back. Reading checks what arrived: a sample of the wrong size, or with a
/// number that is not finite or beyond kLargestSignal, is refused, so nothing of the kind reaches a law or the
/// integrator. Writing into a reused message does not allocate once its sequences have held kMaxJoints entries: see
/// prepare().
#pragma once

#include <cstdint>
#include <string>

#include "base/signals.hpp"
#include "msg/loop.h"

namespace baton {

/// Which step a message belongs to.
struct StepStamp {
  std::uint64_t step = 0;
  std::int64_t time_ns = 0;  // simulated
};
[[nodiscard]] inline StepStamp stampOf(std::uint64_t step, std::int64_t step_ns) {
  return {step, static_cast<std::int64_t>(step) * step_ns};
}

/// Sets memory aside in a message's sequences, once.
void prepare(msg::PlantState& message);
void prepare(msg::Reference& message);
void prepare(msg::JointCommand& message);

void toMessage(const StepStamp& stamp, const RobotState& state, const std::string& holder, std::uint64_t chain_hash,
               msg::PlantState& message);
void toMessage(const StepStamp& stamp, const Contact& contact, msg::Contact& message);
void toMessage(const StepStamp& stamp, const Reference& reference, msg::Reference& message);
void toMessage(const StepStamp& stamp, const std::string& controller, const JointVector& effort,
               std::uint64_t inputs_hash, msg::JointCommand& message);

/// Whether a message describes a signal; if not, the first field that does not, as the IDL calls it, and why.
struct Reading {
  const char* field = nullptr;
  const char* wrong = nullptr;  // "is not finite"
  explicit operator bool() const noexcept { return field == nullptr; }
  [[nodiscard]] std::string text() const { return *this ? "" : std::string(field) + " " + wrong; }
};

/// All leave the signal in some valid state when the message does not describe one of a robot with n joints.
[[nodiscard]] Reading fromMessage(const msg::PlantState& message, int n, RobotState& state);
[[nodiscard]] Reading fromMessage(const msg::Contact& message, Contact& contact);
[[nodiscard]] Reading fromMessage(const msg::Reference& message, int n, Reference& reference);
[[nodiscard]] Reading fromMessage(const msg::JointCommand& message, int n, JointVector& effort);

/// A joint vector to a bounded sequence and back.
void assignSequence(const JointVector& from, std::vector<double>& to);
[[nodiscard]] bool readSequence(const std::vector<double>& from, int n, JointVector& to);

}  // namespace baton
