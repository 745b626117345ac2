/// The plant's use of a BatonArbiter, without the plant: steps open, inputs complete, actions are taken and logged.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "time/baton_arbiter.hpp"

namespace baton::test {

enum Member : int { kFirst, kSecond, kForce, kSpare };

inline constexpr std::uint64_t kMargin = 5;
inline constexpr double kLimit = 50.0;

/// Four controllers, one of them a force law; the first holds the baton; who fails is followed by force, then spare.
inline ArbiterConfig fourControllers() {
  return {.members = {{"first"}, {"second"}, {"force", true}, {"spare"}},
          .holder = kFirst,
          .fallback = {kForce, kSpare},
          .margin_steps = kMargin,
          .max_effort_step = kLimit};
}

inline JointVector efforts(double value) { return JointVector::Constant(3, value); }

inline Forecast readyWith(const JointVector& effort) { return {.is_ready = true, .effort = effort}; }
inline Forecast notReady(const char* reason) {
  Forecast forecast;
  write(forecast.not_ready, "%s", reason);
  return forecast;
}

using Kind = ArbiterAction::Kind;

class ArbiterRun {
 public:
  explicit ArbiterRun(const ArbiterConfig& config = fourControllers()) : arbiter(config) {
    arbiter.open(0);
    drain();
  }

  void request(int target, std::uint64_t at_step = 0, bool force = false, std::uint64_t request_id = 1) {
    arbiter.request({.request_id = request_id, .target = target, .at_step = at_step, .force = force}, step);
    drain();
  }

  /// The open step's inputs are complete: decides what is to be decided in it.
  void consider() {
    arbiter.consider(step, effort, in_contact);
    drain();
  }

  /// Ends the open step, waited for or not, and opens the next one.
  int next() {
    consider();
    const int holder = arbiter.open(++step);
    drain();
    return holder;
  }

  void runTo(std::uint64_t target) {
    while (step < target) next();
  }

  void forecast(std::uint64_t plan_id, int member, double value) {
    arbiter.prepareAcknowledged(plan_id, member, readyWith(efforts(value)));
  }

  void commitAcknowledgedBy(int member) { arbiter.commitAcknowledged(lastPlan().plan_id, member); }

  void fail(int member, const char* reason = "its process has ended") {
    arbiter.memberFailed(member, step, reason);
    drain();
  }

  /// Request to `target` at once and everything after it as it should be, up to the open step before `at_step`.
  void handOverUpTo(int target, bool force = false) {
    request(target, 0, force);
    runTo(lastPlan().forecast_step);
    forecast(lastPlan().plan_id, target, 1.0);
    consider();
    commitAcknowledgedBy(target);
    commitAcknowledgedBy(lastPlan().outgoing);
    runTo(lastPlan().at_step - 1);
  }

  [[nodiscard]] std::vector<Kind> kinds() const {
    std::vector<Kind> result;
    for (const ArbiterAction& action : actions) result.push_back(action.kind);
    return result;
  }
  [[nodiscard]] const HandoverPlan& lastPlan() const { return actions.back().plan; }
  [[nodiscard]] std::string lastReason() const { return actions.back().reason.data(); }

  void drain() {
    while (const std::optional<ArbiterAction> action = arbiter.takeAction()) actions.push_back(*action);
  }

  BatonArbiter arbiter;
  std::uint64_t step = 0;
  JointVector effort = efforts(0.0);  // the holder's
  bool in_contact = false;
  std::vector<ArbiterAction> actions;
};

}  // namespace baton::test
