/// How far the plant may run on: the steps of which everything that has to be complete is here. And how long the run
/// has lasted, in steps, resets included. A plain state machine, fed with what came.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "msg/sim.h"
#include "runtime/scenario.hpp"

namespace baton {

class StepCredit {
 public:
  explicit StepCredit(const Scenario& scenario);

  /// The place of a topic of which every step is awaited; nothing for all others.
  [[nodiscard]] std::optional<std::size_t> placeOf(const std::string& topic) const;
  /// A sample of that topic is here.
  void came(std::size_t place, std::span<const std::byte> payload);
  /// The run is about to go back to its first step, has done so, or does not after all.
  void rewound(const msg::Rewind& rewind);

  /// The last step that is here, whole.
  [[nodiscard]] std::uint64_t acknowledged() const;
  /// Whether the plant is to be told of it; when nothing more comes, of every step.
  [[nodiscard]] bool isDue(bool is_idle) const;
  void told() { told_ = acknowledged(); }
  /// What a rewind waits to hear from here, once.
  [[nodiscard]] std::optional<msg::RewindAck> answer();

  [[nodiscard]] std::uint32_t take() const { return take_; }
  /// The latest state's step, and the steps that have passed since the first one.
  [[nodiscard]] std::uint64_t stateStep() const { return steps_.front().latest; }
  [[nodiscard]] std::uint64_t elapsedSteps() const { return elapsed_; }

 private:
  struct Awaited {
    std::string topic;
    std::uint64_t latest = 0;
    bool has_come = false;
  };
  std::vector<Awaited> steps_;  // plant_state first
  std::uint64_t every_;         // steps between two acknowledgements
  std::uint64_t told_ = 0;
  std::uint64_t elapsed_ = 0;
  std::uint32_t take_ = 0;
  std::optional<msg::Rewind> owed_;  // an answer to this
};

}  // namespace baton
