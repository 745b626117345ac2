/// Dry runs: what would come of a handover at the open step, asked and answered beside the run. The target forecasts
/// the step as it would for a handover, the holder's effort for the same step is taken down when it is known, and the
/// verdict is the arbiter's. Nothing waits for any of it, so the run has the bytes that it has without.
#pragma once

#include <optional>
#include <vector>

#include "time/baton_arbiter.hpp"

namespace baton {

struct DryRun {
  HandoverPlan plan;  // that a request now would make, but for its id
  std::optional<Forecast> forecast;
  std::optional<ForecastStep> step;  // plan.forecast_step, once it is complete
  Verdict verdict;                   // the answer
  bool is_answered = false;
};

class DryRuns {
 public:
  /// `arbiter` must outlive it.
  explicit DryRuns(const BatonArbiter& arbiter) noexcept : arbiter_(arbiter) {}

  /// Returns the plan for whose forecast step, the open one, the target must be asked; nothing when the answer is known
  /// already.
  std::optional<HandoverPlan> ask(const HandoverRequest& request, std::uint64_t open_step);
  void forecastArrived(std::uint64_t request_id, int member, const Forecast& forecast);
  /// All that is to be known of an open step is known, or it ends without; later words on the same step do not count.
  void stepIsKnown(std::uint64_t step, const ForecastStep& known);
  void memberFailed(int member);
  /// Nothing is worth waiting for any more.
  void dropAll(const char* reason);

  [[nodiscard]] bool isIdle() const noexcept { return runs_.empty(); }
  /// Next answer, oldest question first.
  [[nodiscard]] std::optional<DryRun> takeAnswered();

 private:
  static constexpr std::size_t kMaxOpen = 32;
  /// A controller remembers its latest 512 steps.
  static constexpr std::uint64_t kPatience_steps = 512;
  void judgeIfKnown(DryRun& one) const;

  const BatonArbiter& arbiter_;
  std::vector<DryRun> runs_;
};

}  // namespace baton
