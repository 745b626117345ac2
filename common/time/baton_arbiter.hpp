/// Who holds the baton: the two-phase handover and the failover, decided in the plant. A plain state machine; DDS only
/// carries its messages.
///
///   request -> prepare -> (forecast at step F) -> commit -> (acknowledged) -> step K: the incoming controller holds
///
/// F is the step at which the incoming controller forecasts, K = F + margin. Everything is decided at a definite step,
/// so the same scenario decides the same way every time; in lockstep the plant waits (awaits()) for what is missing, in
/// realtime it does without and the handover is refused.
///
/// Controllers are numbered as in the scenario; kBrake stands for the plant's own brake. Nothing here allocates after
/// construction, unless somebody joins.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/state_archive.hpp"
#include "base/types.hpp"
#include "time/forecast.hpp"

namespace baton {

inline constexpr int kBrake = -1;

struct ArbiterConfig {
  std::vector<ArbiterMember> members;
  int holder = kBrake;        // at step 0
  std::vector<int> fallback;  // who takes over from a holder that fails, in order
  std::uint64_t margin_steps = 5;
  std::uint64_t blend_steps = 0;  // unless a request says otherwise
  double max_effort_step = 50.0;  // forecast above this is refused unless forced
  std::uint64_t end_step = 0;     // 0: open end
};

struct HandoverRequest {
  std::uint64_t request_id = 0;  // 0: planned by the scenario
  int target = kBrake;
  std::uint64_t at_step = 0;  // 0: as soon as the margin allows
  bool force = false;
  bool hard = false;                                        // no help: no blend, and the incoming law starts anew
  std::optional<std::uint64_t> blend_steps = std::nullopt;  // as configured when not given; none when hard
};

struct HandoverPlan {
  std::uint64_t plan_id = 0;  // from 1; 0 when none was made
  std::uint64_t request_id = 0;
  int outgoing = kBrake;
  int incoming = kBrake;
  std::uint64_t decided_at_step = 0;
  std::uint64_t forecast_step = 0;
  std::uint64_t at_step = 0;
  bool force = false;
  bool hard = false;
  std::uint64_t blend_steps = 0;
  JointVector forecast_effort_step;  // forecast minus the holder's effort, once compared
};

/// What the arbiter wants published, in this order.
struct ArbiterAction {
  enum class Kind { kPrepare, kCommit, kCancel, kRefused, kDone } kind = Kind::kPrepare;
  HandoverPlan plan;
  ReasonText reason{};  // kCancel, kRefused: why; kDone: why the baton changed hands without a request
};

class BatonArbiter {
 public:
  explicit BatonArbiter(const ArbiterConfig& config);

  // --- news
  void request(const HandoverRequest& request, std::uint64_t open_step) noexcept;
  /// A request that names nobody this run knows.
  void refuseUnknown(std::uint64_t request_id, const char* target, std::uint64_t open_step) noexcept;
  void prepareAcknowledged(std::uint64_t plan_id, int member, const Forecast& forecast) noexcept;
  void commitAcknowledged(std::uint64_t plan_id, int member) noexcept;
  /// The member is gone or misbehaves at `open_step`. If it holds the baton, the next step belongs to the fallback.
  void memberFailed(int member, std::uint64_t open_step, const char* reason) noexcept;

  /// Somebody new stands by. Returns its number. Allocates.
  int memberJoined(const ArbiterMember& member);
  /// A member runs another law now.
  void memberChanged(int member, bool requires_contact) noexcept;
  /// A member that had failed is there again, to stand by.
  void memberReturned(int member) noexcept;
  /// The run ends: a handover under way is refused.
  void runEnded() noexcept;

  /// The plan that a request would make now, without an id, and what speaks against it before anybody is asked; empty
  /// when nothing does.
  [[nodiscard]] HandoverPlan planFor(const HandoverRequest& request, std::uint64_t open_step) const noexcept;
  [[nodiscard]] ReasonText objectionTo(const HandoverPlan& plan, std::uint64_t open_step) const noexcept;

  // --- the run
  /// The open step's inputs are complete: decides on a plan whose forecast step this is.
  void consider(std::uint64_t open_step, const JointVector& holder_effort, bool in_contact) noexcept;
  /// Whether the open step must not end yet because an acknowledgement is missing (lockstep).
  [[nodiscard]] bool awaits(std::uint64_t open_step) const noexcept;
  /// Whose acknowledgement is missing when awaits(); kBrake otherwise.
  [[nodiscard]] int awaitedMember(std::uint64_t open_step) const noexcept;
  /// A step opens: who holds it. Handovers and failovers take effect here.
  int open(std::uint64_t step) noexcept;

  [[nodiscard]] int holder() const noexcept { return holder_; }
  /// At the first step of a handover: who held before and is to send one last command; kBrake otherwise.
  [[nodiscard]] int outgoingAt(std::uint64_t step) const noexcept;
  /// Whether the holder changed at this step, by handover or failover.
  [[nodiscard]] bool changedAt(std::uint64_t step) const noexcept { return changed_at_ && *changed_at_ == step; }
  [[nodiscard]] const std::vector<ArbiterMember>& members() const noexcept { return config_.members; }
  /// Empty for kBrake.
  [[nodiscard]] const std::string& nameOf(int member) const noexcept;
  [[nodiscard]] double maxEffortStep() const noexcept { return config_.max_effort_step; }
  /// The handover under way, nullptr when there is none.
  [[nodiscard]] const HandoverPlan* planUnderWay() const noexcept { return phase_ == Phase::kIdle ? nullptr : &plan_; }
  [[nodiscard]] bool hasFailed(int member) const noexcept;
  /// The step that was open when a member that hasFailed() did.
  [[nodiscard]] std::uint64_t failedAt(int member) const noexcept;

  /// Neither a handover nor a failover is under way at this step, so that holder and failures are all there is to
  /// remember.
  [[nodiscard]] bool isQuiet(std::uint64_t step) const noexcept;
  /// What to remember at a step at which isQuiet().
  void archive(StateArchive& state) noexcept;
  /// A member by its name: the list of a branch may have another order, by when its controllers were started.
  void archiveMember(StateArchive& state, int& member) const noexcept;
  /// A handover under way is refused: the run goes back to its first step.
  void prepareRewind() noexcept;
  /// Back to the state before the first step. Whoever is `absent` has failed there; a holder that has is followed by
  /// the fallback.
  void rewind(const std::vector<int>& absent) noexcept;
  /// From now on the run ends at this step. A handover that would take place there or later is refused.
  void endAt(std::uint64_t step) noexcept;

  /// Next action to publish, oldest first.
  [[nodiscard]] std::optional<ArbiterAction> takeAction() noexcept;

 private:
  enum class Phase { kIdle, kPreparing, kCommitted };
  void act(ArbiterAction::Kind kind, const HandoverPlan& plan, const char* format, ...) noexcept
      __attribute__((format(printf, 4, 5)));
  void drop(ArbiterAction::Kind outcome, const char* reason) noexcept;

  ArbiterConfig config_;
  int first_holder_;
  Phase phase_ = Phase::kIdle;
  HandoverPlan plan_;
  std::uint64_t last_plan_id_ = 0;
  int holder_ = kBrake;
  std::optional<std::uint64_t> holder_failed_at_;  // until the next step opens
  bool contact_ = false;
  std::vector<char> failed_;
  std::vector<std::uint64_t> failed_at_;  // open step, of those that have failed
  ReasonText failure_{};
  std::optional<std::uint64_t> changed_at_;
  std::optional<std::uint64_t> handover_at_;  // changed by plan, not by failure
  int handed_over_by_ = kBrake;               // plan_ may be the next one by then
  // acknowledgements of the current plan
  std::optional<Forecast> forecast_;
  bool incoming_committed_ = false;
  bool outgoing_committed_ = false;
  // a small ring of actions
  static constexpr std::size_t kQueue = 16;
  std::array<ArbiterAction, kQueue> queue_{};
  std::size_t queue_head_ = 0;
  std::size_t queue_size_ = 0;
};

}  // namespace baton
