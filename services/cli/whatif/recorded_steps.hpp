/// A recorded run step by step: what a law may know of a step, and the torque that was commanded for it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/signals.hpp"
#include "mcap/source.hpp"

namespace baton {

/// A payload of the loop, decoded.
template <class T>
struct RecordedInput {
  T value;
  std::uint64_t hash = 0;  // of its bytes
};

struct RecordedCommand {
  std::string controller;
  std::optional<JointVector> effort;  // nothing: the law had none to give
  std::uint64_t inputs_hash = 0;
};

/// What was not recorded, or what a controller would refuse, is not there.
struct RecordedStep {
  std::uint64_t step = 0;
  std::uint64_t log_time_ns = 0;  // of the state
  std::uint64_t publish_time_ns = 0;
  std::uint64_t chain_hash = 0;  // of all payloads of the loop up to the step before
  std::string holder;            // empty: the plant's brake
  std::optional<RecordedInput<RobotState>> state;
  std::optional<RecordedInput<Reference>> reference;
  std::optional<RecordedInput<Contact>> contact;
  std::vector<RecordedCommand> commands;  // for this step: the holder's, and at its first the one before it
  std::optional<JointVector> felt;        // what the joints felt over the step

  [[nodiscard]] const RecordedCommand* commandOfHolder() const;
  /// The effort that the holder commanded; while the brake held, what the joints felt.
  [[nodiscard]] const std::optional<JointVector>* effort() const;
  /// The hash that a controller's command for this step names: of its inputs, with the contact or without.
  [[nodiscard]] std::uint64_t inputsHash(bool uses_force) const;
};

/// Calls f for every step of which there is a state, in order, and never holds more than a window of them. Messages of
/// one step may be far apart in the file, but not further than that. Throws what reading a recording throws.
/// @param begin_ns  log time from which on everything is of the run's last take.  @param n  joints.
/// @param progress  called now and then with the part that has been read, from 0 to 1.
void forEachStep(const mcap::Source& reader, std::uint64_t begin_ns, int n,
                 const std::function<void(const RecordedStep&)>& f, const std::function<void(double)>& progress = {});

}  // namespace baton
