/// How punctual the steps are and how soon handovers take effect: histograms that are told with the status.
#pragma once

#include <cstdint>
#include <optional>

#include "msg/sim.h"
#include "time/histogram.hpp"

namespace baton {

/// The clock is the caller's: any steady nanosecond count.
class StepTiming {
 public:
  /// A step has opened; `runs`: it goes on by itself, no operator holds it.
  void opened(std::int64_t now_ns, bool runs) noexcept;
  /// An operator holds the open step: how long it takes says nothing, nor how long a handover under way does.
  void interrupted() noexcept {
    opened_ns_.reset();
    plan_ = 0;
  }
  /// Realtime: the open step ends, so long after its deadline; `is_old` when its torque was kept from the step before.
  void ticked(std::int64_t lateness_ns, bool is_old) noexcept;

  /// A plan for a handover has been made; its step has opened. One that comes to nothing leaves no trace.
  void planned(std::uint64_t plan_id, std::int64_t now_ns) noexcept;
  void handedOver(std::uint64_t plan_id, std::int64_t now_ns) noexcept;

  [[nodiscard]] msg::TimingStatus report(std::uint64_t step, std::uint64_t missed_steps) const;

 private:
  Histogram period_ns_;
  Histogram jitter_ns_;
  Histogram command_age_;
  std::int64_t age_steps_ = 0;
  std::optional<std::int64_t> opened_ns_;  // of the open step, while its period counts
  Histogram handover_ns_;
  std::uint64_t plan_ = 0;  // under way, made while the run went on
  std::int64_t planned_ns_ = 0;
  std::uint64_t last_plan_ = 0;  // that took effect
  std::int64_t last_handover_ns_ = 0;
};

}  // namespace baton
