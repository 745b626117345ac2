/// The processes of the raw chain. They pass on the messages of Baton's loop in its order and do nothing else: no
/// physics, no law, no hash. Each sample is checked to be of the step it should be, and the numbers in it come from the
/// numbers it answers, so that a chain that skips a hop cannot pass.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "raw_node.hpp"

namespace raw {

struct Chain {
  Network network;
  int hops = 3;           // 3: the controller waits for the contact of the step; 2: it does not
  bool observed = false;  // one more process reads everything
  std::uint64_t warm_up = 0;
  std::uint64_t steps = 0;  // after the warm-up
};

/// A process that serves until it is destroyed.
class Role {
 public:
  virtual ~Role() = default;
  virtual void awaitMatches() const = 0;
};

/// The time master: publishes the state, takes contact and command, publishes the next.
class Plant : public Role {
 public:
  /// Runs the chain, once all are ready. Returns how long each step after the warm-up took, in ns.
  virtual std::vector<std::int64_t> run() = 0;
};

[[nodiscard]] std::unique_ptr<Plant> makePlant(const Chain& chain);
[[nodiscard]] std::unique_ptr<Role> makeEnvironment(const Chain& chain);
[[nodiscard]] std::unique_ptr<Role> makeTrajectory(const Chain& chain);
[[nodiscard]] std::unique_ptr<Role> makeController(const Chain& chain);
[[nodiscard]] std::unique_ptr<Role> makeObserver(const Chain& chain);

}  // namespace raw
